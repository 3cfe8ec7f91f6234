// Gives vpm_tool_header a source; the target exists for its precompiled headers.
int main() {}
