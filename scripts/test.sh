#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test. VPM_CHECKERS names further packages, whose tests are skipped without
# them, such as "chromium-headless-shell clang-format-14".
set -euo pipefail
# shellcheck source=scripts/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_packages "${query_packages[@]}"
# shellcheck disable=SC2086  # several words
install_meanwhile "${packages[@]}" "${test_packages[@]}" "${test_run_packages[@]}" ${VPM_CHECKERS:-}
build
say "Running the tests"
# Takes memory in large pages where the kernel leaves that to programs: touching it for the first time is a fifth of what the
# tests cost.
export GLIBC_TUNABLES=${GLIBC_TUNABLES:-glibc.malloc.hugetlb=1}
# One more than there are cores, for tests wait for disks, processes and browsers; with twice as many they took a tenth longer.
ctest --test-dir "$repository/build/release" --output-on-failure --parallel "$(($(nproc) + 1))" "$@"
