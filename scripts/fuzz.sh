#!/usr/bin/env bash
# Fuzzes every reader and writes what came of it: scripts/fuzz.sh [SECONDS [TARGET...]]
#
# Builds the preset `fuzz` (clang 14), makes the seeds, and runs each target for SECONDS (30) on them, on what earlier runs
# found in build/fuzz/corpus, and on tests/fuzz/findings. libFuzzer's weights by entropy are off: most inputs take less time
# than they do. A crash, a foreign exception, more than 5 s of the processor for an input, more than
# 320 MB in one piece or 2 GB in all is a finding, kept in build/fuzz/findings/TARGET. Several targets run at once, one on each
# core; VPM_FUZZ_JOBS says how many. Executions, coverage and findings are added to tests/results/fuzz.json.
# VPM_FUZZ_LONGEST is the length in bytes of the longest input (16384).
# Exit status: 0 if nothing was found, 1 otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=${1:-30}
shift || true
build=build/fuzz
program=$PWD/$build/bin/vpm-fuzz
if [[ -z ${VPM_FUZZ_BUILT:-} ]]; then
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz
fi
python3 tests/fuzz/make_seeds.py $build/seeds
if [[ $# -gt 0 ]]; then
  targets=("$@")
else
  # Without a target, the program lists them all.
  read -ra targets <<<"$(VPM_FUZZ_TARGET='' "$program" 2>&1 | sed 's/^[^:]*: *//')"
fi

export UBSAN_OPTIONS=print_stacktrace=1
fuzz() {
  local target=$1 corpus=$build/corpus/$1 found=$build/findings/$1 findings=()
  mkdir -p "$corpus" "$found"
  [[ -d tests/fuzz/findings/$target ]] && findings=(tests/fuzz/findings/"$target")
  # Goes on after a finding until the time is over.
  local end=$((SECONDS + seconds)) left
  : >"$build/$target.log"
  while left=$((end - SECONDS)) && ((left > 0)); do
    VPM_FUZZ_TARGET=$target nice "$program" "$corpus" "$build/seeds/$target" "${findings[@]}" \
      -max_total_time=$left -timeout=120 -report_slow_units=120 -rss_limit_mb=2048 -max_len=${VPM_FUZZ_LONGEST:-16384} -entropic=0 \
      -dict=tests/fuzz/words.dict -artifact_prefix="$found/" -print_final_stats=1 -close_fd_mask=1 \
      >>"$build/$target.log" 2>&1 && break
  done
  return 0  # report.py counts the findings
}
export -f fuzz
export build program seconds
printf '%s\n' "${targets[@]}" | xargs -P "${VPM_FUZZ_JOBS:-$(nproc)}" -I{} bash -c 'fuzz {}'
python3 tests/fuzz/report.py $build tests/results/fuzz.json "${targets[@]}"
