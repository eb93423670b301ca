#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes what reads files and command lines: run.sh FOLDER [SECONDS [TARGET...]]
#
# FOLDER is a build of the target `fuzz` by clang++, as tests/run.sh makes it in build/address.
# Every target of tests/fuzz runs for SECONDS, as many at a time as there are processors.
# FOLDER/fuzz/corpus keeps what reaches new code, and the next run goes on from there: run.sh FOLDER
# 3600 runs for long, names of targets choose some of them. Without SECONDS it makes the same changes
# in the same order each time, and as many on a fast machine as on a slow one (ten seconds for
# each target), so that what it finds comes of a change of the code.
# An input that ends a target is a finding: it stays in FOLDER/fuzz/findings, the command that
# repeats it is printed, and the exit code is 1. Where CI is set, the input is printed too.
set -euo pipefail

sources=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(realpath "${1:?run.sh FOLDER [SECONDS [TARGET...]]}")
seconds=${2:-300}
targets=("${@:3}")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(basename -s _fuzz.cpp "$sources"/*_fuzz.cpp)
corpus=$build/fuzz/corpus findings=$build/fuzz/findings logs=$build/fuzz/logs

# The largest input is a frame of some thousand pixels: what takes more seconds or MiB follows a
# size that a header claims.
limits=(-max_len=65536 -timeout=30 -report_slow_units=30 -rss_limit_mb=2048)
launch=()
declare -A runs=()  # none: until the seconds are over
if [ $# -lt 2 ]; then
  runs=([camera]=10000 [deep]=8000 [environment]=1000 [exr]=2000 [frame]=3000 [options]=270)
  limits+=(-seed=1)
  # At the same addresses: libFuzzer tries values that the code compares.
  ! setarch -R true 2>/dev/null || launch=(setarch -R)
fi
export ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$sources/../leaks.txt:print_suppressions=0

fuzz_target() {
  local program=$build/fuzz/$1_fuzz options=("${limits[@]}" -artifact_prefix="$findings/$1-")
  [ ! -f "$sources/$1.dict" ] || options+=(-dict="$sources/$1.dict")
  [ -z "${runs[$1]:-}" ] || options+=(-runs="${runs[$1]}")
  mkdir -p "$corpus/$1"
  [ -n "$(ls -A "$corpus/$1")" ] || "$program" --seeds "$corpus/$1" || return
  "${launch[@]}" "$program" "${options[@]}" -max_total_time="$seconds" -print_final_stats=1 \
    "$corpus/$1"
}

# The last number behind a name in the log of a target.
number_in_log() { grep -aoE "$2 *[0-9]+" "$logs/$1.log" | tail -1 | grep -oE '[0-9]+$' || echo '?'; }

report_target() {
  printf '%-12s %8s executions %6s/s  cov %6s  corpus %5s\n' "$1" \
    "$(number_in_log "$1" number_of_executed_units:)" \
    "$(number_in_log "$1" average_exec_per_sec:)" "$(number_in_log "$1" cov:)" \
    "$(find "$corpus/$1" -type f | wc -l)"
}

report_findings() {
  local input
  grep -ahE 'ERROR: |runtime error: |FINDING: |error while loading' "$logs/$1.log" || tail -3 "$logs/$1.log"
  for input in "$findings/$1"-*; do
    [ -f "$input" ] || continue
    echo "  $build/fuzz/$1_fuzz $input"
    [ -z "${CI:-}" ] || (echo 'base64 --decode <<END | gunzip' && gzip -9 <"$input" | base64 && echo END)
  done
}

mkdir -p "$corpus" "$findings" "$logs"
for target in "${targets[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done
  rm -f "$logs/$target.done"
  (fuzz_target "$target" >"$logs/$target.log" 2>&1 && touch "$logs/$target.done") &
done
wait

code=0
for target in "${targets[@]}"; do
  report_target "$target"
  [ -f "$logs/$target.done" ] || { code=1; report_findings "$target"; }
done
exit $code
