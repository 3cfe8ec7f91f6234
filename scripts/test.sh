#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test.
set -euo pipefail
# shellcheck source=scripts/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_missing
build
say "Running the tests"
ctest --test-dir "$repository/build/release" --output-on-failure --parallel "$(nproc)" "$@"
