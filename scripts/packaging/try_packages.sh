#!/usr/bin/env bash
# try_packages.sh [--all]: installs the Debian packages in /packages on this machine, an empty Debian 12, and shows that they need
# nothing but what they depend on and do their work: the programs' main job, and the page of the Python module. With --all also that
# lintian finds no fault in them, and that examples/consumer is built with them by CMake and by pkg-config. debian_packages.sh and
# continuous integration run it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
repository=$PWD
inputs=$repository/tests/tools/inputs
camera=60,60,31.5,23.5
pose=0,0,1,0,0,0,1  # half of the cube is behind the wall

install() { DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "$@"; }
half() { vpm-query "$@" --cloud wall.vpmc --pose $pose | grep -E '"volume_fraction":0.(49|50)'; }

install /packages/*.deb
cd "$(mktemp -d)"
vpm-pack "$inputs/cube.off" -o cube.vpmp --spheres 50
vpm-graph cube.vpmp -o cube.vpmg
vpm-normals "$inputs/wall.png" -o wall.vpmc --intrinsics $camera
half --tool cube.vpmg
half --tool "$inputs/cube.off"

install python3-pytest
VPM_SOURCE=$repository python3 -m pytest -q -p no:cacheprovider "$repository/tests/python/test_page.py"
if [[ ${1:-} != --all ]]; then exit; fi

install g++ cmake make pkg-config lintian
lintian --fail-on error,warning --tag-display-limit 0 /packages/*.deb
cmake -S /usr/share/doc/vpm/examples/consumer -B consumer
cmake --build consumer
consumer/mesh-to-answer "$inputs/cube.off" "$inputs/wall.png" $camera $pose
consumer/control-loop cube.vpmg
# shellcheck disable=SC2046  # several words
g++ -std=c++20 /usr/share/doc/vpm/examples/consumer/control_loop.cpp $(pkg-config --cflags --libs vpm) -o loop
./loop cube.vpmg
