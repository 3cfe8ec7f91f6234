#!/usr/bin/env python3
"""header_alone.py HEADER: prints a source that includes HEADER alone, catches the errors that its comments promise, and
holds the example of its first comment, with names that the example does not declare as parameters."""
import pathlib
import re
import sys

header = pathlib.Path(sys.argv[1])
text = header.read_text()
first_comment = re.match(r"(//[^\n]*\n)+", text).group()
example = re.findall(r"^//   (.*)$", first_comment, re.MULTILINE)
named = [name for line in example for name in re.findall(r"<vpm/(\w+\.h)>", line)]

for name in dict.fromkeys([header.name, *named]):
    print(f"#include <vpm/{name}>")
print("namespace {")
if re.search(r"\bError\((?:refused|invalid_argument|unavailable|cannot_write)\)", text):
    print("""[[maybe_unused]] bool is_caught() {
  try {
    return false;
  } catch (const vpm::Error& error) {
    return error.kind() == vpm::ErrorKind::refused && error.hint().empty();
  }
}""")
if example:
    code = "\n  ".join(re.sub(r"\s*//.*", "", line) for line in example)
    free = {"pose": "const vpm::Pose& pose", "camera_to_world": "const vpm::Pose& camera_to_world",
            "intrinsics": "const vpm::Intrinsics& intrinsics", "camera": "const auto& camera", "query": "vpm::Query& query",
            "scene": "const vpm::Scene& scene", "numbers": "const double* numbers", "count": "std::size_t count",
            "stream": "void* stream"}
    declared = set(re.findall(r"\bvpm::\w+ (\w+)", code))
    parameters = [parameter for name, parameter in free.items()
                  if re.search(rf"(?<![\w.:]){name}\b", code) and name not in declared]
    print(f"[[maybe_unused]] void example({', '.join(parameters)}) {{\n  {code}\n}}")
print("}  // namespace")
