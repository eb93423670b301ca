#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes what reads files and command lines: run.sh FOLDER [SECONDS [TARGET...]]
#
# FOLDER is a build by clang with -DSSDO_FUZZ=ON -DSSDO_SANITIZE=address,undefined -DSSDO_ONE_ISA=scalar.
# Every target of tests/fuzz runs for SECONDS, 60 by default, as many at a time as there are
# processors. FOLDER/fuzz/corpus keeps what reaches new code, so that the next run goes on from
# there: run.sh FOLDER 3600 runs for long, and more names of targets choose some of them.
# An input that ends a target is a finding: it stays in FOLDER/fuzz/findings, the command to repeat
# it is printed, and the exit code is 1.
set -euo pipefail

sources=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(realpath "${1:?run.sh FOLDER [SECONDS [TARGET...]]}")
seconds=${2:-60}
targets=("${@:3}")
[ ${#targets[@]} -gt 0 ] || targets=($(basename -s _fuzz.cpp "$sources"/*_fuzz.cpp))
corpus=$build/fuzz/corpus findings=$build/fuzz/findings logs=$build/fuzz/logs

# Memory is that of the largest input many times over; a size that a header claims is more.
limits=(-max_len=65536 -timeout=10 -rss_limit_mb=2048)

export ASAN_OPTIONS=detect_leaks=1
export UBSAN_OPTIONS=print_stacktrace=1

# Runs TARGET on its corpus and a new folder, which then joins the corpus without what adds nothing.
fuzz_target() {
  local target=$1 program=$build/fuzz/$1_fuzz log=$logs/$1.log kept=$corpus/$1 merged=$corpus/$1.merged
  local options=("${limits[@]}" -artifact_prefix="$findings/$target-")
  [ ! -f "$sources/$target.dict" ] || options+=(-dict="$sources/$target.dict")
  mkdir -p "$kept"
  [ -n "$(ls -A "$kept")" ] || "$program" --seeds "$kept"
  "$program" "${options[@]}" -max_total_time="$seconds" -print_final_stats=1 "$kept" >"$log" 2>&1 || return 0
  rm -rf "$merged" && mkdir "$merged"
  "$program" "${limits[@]}" -merge=1 "$merged" "$kept" >"$log.merge" 2>&1 || return 0
  rm -r "$kept" && mv "$merged" "$kept"
}

# The number behind a name in a log of libFuzzer, the last one.
last_number() { grep -oE "$2 *[0-9]+" "$1" | tail -1 | grep -oE '[0-9]+$' || echo 0; }

report_target() {
  local log=$logs/$1.log
  printf '%-12s %8s executions %6s/s  cov %6s  corpus %5s\n' "$1" \
    "$(last_number "$log" 'number_of_executed_units:')" "$(last_number "$log" 'average_exec_per_sec:')" \
    "$(last_number "$log" 'cov:')" "$(ls "$corpus/$1" | wc -l)"
}

mkdir -p "$corpus" "$findings" "$logs"
export -f fuzz_target
for target in "${targets[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n; done
  fuzz_target "$target" &
done
wait

for target in "${targets[@]}"; do report_target "$target"; done
found=0
for input in "$findings"/*; do
  [ -f "$input" ] || continue
  found=1 target=$(basename "$input") target=${target%%-*}
  grep -hE 'ERROR: |runtime error: |FINDING: ' "$logs/$target.log" | tail -1 || true
  echo "$build/fuzz/${target}_fuzz $input"
done
exit $found
