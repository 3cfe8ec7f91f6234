#!/usr/bin/env python3
"""public_test.py INCLUDE LIBRARY ...: the shared libraries export what INCLUDE's headers declare with VPM_API and nothing
else of namespace vpm; the headers are few and short, and name no library but the standard one."""
import pathlib
import re
import subprocess
import sys

MOST_HEADERS, MOST_LINES = 20, 1720
FOREIGN = re.compile(r"#include\s*<(?!vpm/)[^>]*[/.][^>]*>|cuda_runtime|nlohmann|tbb::|openvdb|OpenMesh", re.IGNORECASE)

headers = sorted(pathlib.Path(sys.argv[1]).glob("*.h"))
texts = {header.name: header.read_text() for header in headers}
faults = []

lines = sum(text.count("\n") for text in texts.values())
if len(headers) > MOST_HEADERS or lines > MOST_LINES:
    faults.append(f"{len(headers)} headers of {lines} lines; at most {MOST_HEADERS} and {MOST_LINES} are wanted")
for name, text in texts.items():
    for found in FOREIGN.findall(text):
        faults.append(f"{name}: {found} is of another library")

together = re.sub(r"//[^\n]*|#[^\n]*", "", "\n".join(texts.values()))
classes = set(re.findall(r"(?:class|struct) VPM_API (\w+)", together))
functions = set(re.findall(r"VPM_API [^;{()]*?\b(\w+)\(", together))
all_exported = []
for library in sys.argv[2:]:
    table = subprocess.run(["nm", "-DC", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    exported = [line.split(maxsplit=2)[2] for line in table.splitlines()]
    all_exported += exported
    for symbol in exported:
        name = re.sub(r"^(typeinfo name|typeinfo|vtable|VTT|guard variable|construction vtable) for ", "", symbol)
        path = re.match(r"vpm::([\w~:]+)", name)
        if path is None:
            continue
        parts = [part for part in path.group(1).split("::") if part]
        if parts[0] not in classes and parts[-1] not in functions:
            faults.append(f"{library} exports {symbol}, which no public header declares")
    if not any(symbol.startswith("vpm::") for symbol in exported):
        faults.append(f"{library} exports nothing of vpm")
if len(sys.argv) > 3:  # both libraries
    for name in classes:
        if not any(symbol.startswith(f"vpm::{name}::") for symbol in all_exported):
            faults.append(f"no library exports {name}")
    for name in functions - classes:
        if not any(re.search(rf"\b{name}(\[|\()", symbol) for symbol in all_exported):
            faults.append(f"no library exports {name}()")

for fault in faults:
    print(fault)
sys.exit(1 if faults else 0)
