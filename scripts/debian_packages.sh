#!/usr/bin/env bash
# debian_packages.sh BUILD: makes the packages vpm, libvpm0, libvpm-dev and python3-vpm of a build tree with VPM_SOLID and VPM_PYTHON, in
# BUILD/packages, and tries them in an empty Debian 12 by packaging/try_packages.sh --all. Exit status as for empty_root.sh, which it
# calls: the packages are made where that is 77, too.
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
VPM_PACKAGES=$build/packages exec "$scripts/empty_root.sh" "apt-get update -q" "scripts/packaging/try_packages.sh --all"
