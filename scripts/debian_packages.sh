#!/usr/bin/env bash
# debian_packages.sh BUILD: makes the packages vpm, libvpm0, libvpm-dev and python3-vpm of a build tree with VPM_SOLID and VPM_PYTHON, in
# BUILD/packages, and shows in an empty Debian 12 that lintian finds no errors in them, that they need nothing but what they depend
# on, and that they do their work: the programs' main job, examples/consumer by CMake and by pkg-config, and the page of the Python
# module. Exit status as for empty_root.sh, which it calls: the packages are made where that is 77, too.
set -euo pipefail
if [[ $# -ne 1 || ! -f $1/CPackConfig.cmake ]]; then
  echo "usage: debian_packages.sh BUILD; BUILD is a build tree, like build/release" >&2
  exit 2
fi
scripts=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(cd "$1" && pwd)
rm -rf "$build/packages"
(cd "$build" && cpack -G DEB >/dev/null)
rm -rf "$build/packages/_CPack_Packages"
ls -l "$build/packages"

install="apt-get install -q -y --no-install-recommends"
inputs=/src/vpm/tests/tools/inputs
camera=60,60,31.5,23.5
pose=0,0,1,0,0,0,1  # half of the cube is behind the wall
half="grep -E '\"volume_fraction\":0.(49|50)'"
# shellcheck disable=SC2016  # the root's shell expands $(...)
VPM_PACKAGES=$build/packages exec "$scripts/empty_root.sh" \
  "apt-get update -q && $install /packages/*.deb" \
  "cd /tmp && vpm-pack $inputs/cube.off -o cube.vpmp --spheres 50 && vpm-graph cube.vpmp -o cube.vpmg && \
vpm-normals $inputs/wall.png -o wall.vpmc --intrinsics $camera && \
vpm-query --tool cube.vpmg --cloud wall.vpmc --pose $pose | $half && vpm-query --tool $inputs/cube.off --cloud wall.vpmc --pose $pose | $half" \
  "$install g++ cmake make pkg-config python3-pytest lintian" \
  "lintian --fail-on error --no-tag-display-limit /packages/*.deb" \
  "cd /tmp && cmake -S /usr/share/doc/vpm/examples/consumer -B consumer && cmake --build consumer && \
consumer/mesh-to-answer $inputs/cube.off $inputs/wall.png $camera $pose && consumer/control-loop cube.vpmg" \
  'cd /tmp && g++ -std=c++20 /usr/share/doc/vpm/examples/consumer/control_loop.cpp $(pkg-config --cflags --libs vpm) -o loop && ./loop cube.vpmg' \
  "VPM_SOURCE=/src/vpm python3 -m pytest -q -p no:cacheprovider tests/python/test_page.py"
