// What vpm_tool_header is made of: nothing but its precompiled headers.
int main() {}
