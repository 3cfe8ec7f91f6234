# shellcheck shell=bash
# Sourced by the findings: pinned public packages in a temporary folder, which goes at the end. Exit status of a finding: 0 where
# the behaviour is as told, 1 where it has changed, 2 where the packages cannot be had.
set -euo pipefail
# shellcheck disable=SC2034  # used by the scripts that source this one
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cannot() {
  echo "cannot be tried here: $*" >&2
  exit 2
}

# Unpacks Debian packages NAME=VERSION, and what of their needs is not installed, below $work/root, without installing any.
# Names given after -- are taken as they are, without their needs.
debian() {
  local wanted=() bare=() missing
  while [[ $# -gt 0 && $1 != -- ]]; do wanted+=("$1"); shift; done
  [[ $# -eq 0 ]] || bare=("${@:2}")
  missing=$(apt-get -s -qq --no-install-recommends install "${wanted[@]}" 2>apt.log | awk '$1 == "Inst" { print $2 }') ||
    cannot "apt-get: $(tail -1 apt.log)"
  mkdir -p debs root
  if [[ -n $missing || ${#bare[@]} -gt 0 ]]; then
    # shellcheck disable=SC2086  # one name a word
    (cd debs && apt-get -qq download $missing "${bare[@]}") >apt.log 2>&1 || cannot "apt-get: $(tail -1 apt.log)"
  fi
  for package in debs/*.deb; do [[ ! -e $package ]] || dpkg -x "$package" root; done
  local libraries=$work/root/usr/lib/$(uname -m)-linux-gnu
  export LD_LIBRARY_PATH=$libraries:$work/root/usr/lib LIBRARY_PATH=$libraries
  export CPLUS_INCLUDE_PATH=$work/root/usr/include:$work/root/usr/include/eigen3:/usr/include/eigen3
}

# Compiles the C++ of the standard input and runs it: run_cpp OPTIONS...
run_cpp() {
  cat >finding.cpp
  g++ -std=c++17 -O1 -w finding.cpp -o finding "$@" -Wl,--allow-shlib-undefined
  ./finding
}

# Installs npm packages NAME@VERSION in the folder.
npm_packages() {
  npm install --silent --no-audit --no-fund --ignore-scripts --no-save --prefix "$work" "$@" >npm.log 2>&1 ||
    cannot "npm: $(tail -1 npm.log)"
}

# Runs the JavaScript module of the standard input.
run_js() {
  cat >finding.mjs
  node finding.mjs
}
