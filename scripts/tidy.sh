#!/usr/bin/env bash
# tidy.sh [BASE]: runs clang-tidy 14 (Debian: clang-tidy-14), with the checks of .clang-tidy, on the C++ files that differ from
# BASE, by default from the last commit's parent. Exit status 1 if it finds something.
#
# Takes the compile commands of build/release, which must have been configured, less what clang does not know: GCC's
# precompiled headers and warnings. A source of a unity build takes the command of the file that includes it, and a changed header is
# read through the source of its name or else through one that includes it. A source takes 10 to 40 s.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
base=${1:-HEAD~1}
commands=build/release/compile_commands.json
[[ -e $commands ]] || { echo "tidy.sh: no $commands: run cmake --preset release first" >&2; exit 2; }
mkdir -p build/tidy
mapfile -t changed < <(git diff --name-only --diff-filter=d "$base" -- '*.cpp' '*.h')
mapfile -t sources < <(python3 - "$commands" build/tidy/compile_commands.json "${changed[@]}" <<'PYTHON'
import json, pathlib, re, sys
commands, out, changed = sys.argv[1], sys.argv[2], sys.argv[3:]
root = pathlib.Path.cwd()
entries = {}
for entry in json.load(open(commands)):
    if not entry["file"].endswith((".cpp", ".cxx")) or "cmake_pch" in entry["file"]:
        continue
    command = re.sub(r" -Winvalid-pch| -include \S+cmake_pch\.hxx| -Werror| -fpch-preprocess", "", entry["command"])
    command = re.sub(r"^(\S*env \S+ )?\S*ccache ", "", command)
    parts = [entry["file"]]
    if "/Unity/" in entry["file"] and pathlib.Path(entry["file"]).exists():
        parts = re.findall(r'#include "([^"]+\.cpp)"', pathlib.Path(entry["file"]).read_text())
    for part in parts:
        path = str(pathlib.Path(entry["directory"], part).resolve())
        entries.setdefault(path, {"directory": entry["directory"], "file": path, "command": command.replace(entry["file"], path)})
json.dump(list(entries.values()), open(out, "w"))
sources = {}
for name in changed:
    path = str(root / name)
    if name.endswith(".h"):
        same = str(pathlib.Path(path).with_suffix(".cpp"))
        users = [same] if same in entries else [
            source for source in entries if source.startswith(str(root)) and "/build/" not in source
            and re.search(r'[<"](\S*/)?' + re.escape(pathlib.Path(name).name) + '[>"]', pathlib.Path(source).read_text())]
        path = users[0] if users else None
    if path in entries:
        sources[path] = None
    else:
        print(f"tidy.sh: {name} is in no compile command", file=sys.stderr)
print("\n".join(sources))
PYTHON
)
[[ -n ${sources[*]} ]] || { echo "tidy.sh: nothing changed since $base"; exit 0; }
echo "clang-tidy reads ${#sources[@]} of ${#changed[@]} changed files"
printf '%s\0' "${sources[@]}" | xargs -0 -n 1 -P "${VPM_TIDY_JOBS:-$(nproc)}" \
  clang-tidy-14 -p build/tidy --quiet --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-error
