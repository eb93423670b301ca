#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A shot on a farm: Slurm, GNU parallel and make run the commands of man/ssdo-farm.7 while tasks are
# killed, cancelled and sent to other nodes. The shot ends complete, with the bits of a local run. So
# does a shot whose frames are made with those around them, in chunks of 1, 5 and 48 frames.
# Usage: run.sh [SSDO]; by default the binary in build/release. As root, in 2 to 5 minutes.
set -euo pipefail

farm=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$farm/../.." && pwd)
export PATH=$PATH:/usr/sbin:/sbin
source "$farm/cluster.sh"
source "$farm/checks.sh"

first=1001 last=1048  # of the man page's shot

# Slurm's daemons start tasks as their users, so they are root's.
check_machine() {
  local program missing=()
  [ "$(id -u)" -eq 0 ] || fail "Slurm's daemons need root; run this as root"
  for program in "${cluster_programs[@]}" parallel make oiiotool; do
    command -v "$program" >/dev/null || missing+=("$program")
  done
  [ ${#missing[@]} -eq 0 ] ||
    fail "missing programs: ${missing[*]}; install slurm-wlm munge parallel make openimageio-tools"
  [ -x "$tool" ] || fail "$tool is missing; build it or name another binary"
}

# A camera that pans over the still life: windows of 192 x 108, whose P stay as they are.
make_shot() {
  local frame steps=()
  mkdir shot
  for ((frame = first; frame <= last; frame++)); do
    local step=$((frame - first))
    steps+=(--dup --cut "192x108+$((40 + 6 * step))+$((60 + 2 * step))" -o "shot/shot.$frame.exr" --pop)
  done
  oiiotool "$root/data/still_life.exr" "${steps[@]}"
  cp "$root/data/environments/sky.exr" .
}

run_locally() {
  ssdo shot/shot.####.exr -o local/relit.####.exr -o local/relit.####.png --env sky.exr --create-dirs
}

# example NAME: the lines of man/ssdo-farm.7 between .EX and .EE after the comment with that name.
example() {
  sed -n "/^\.\\\\\" example: $1\$/,/^\.EE/ { /^\./!p }" "$root/man/ssdo-farm.7" |
    sed 's/\\-/-/g; s/\\(aq/'"'"'/g; s/\\&//g; s/\\e/\\/g' | grep .
}

run_example() { bash -euo pipefail -c "$(example "$1")"; }

# The process that writes a temporary, by its name.
writer_of() { sed 's/.*\.ssdo-[^-]*-\([0-9]*\)-.*/\1/' <<<"$1"; }

# catch_writer [PID]: stops a task while it writes a frame, other than PID, and prints its process id.
# Once it is stopped the temporary must still be there.
catch_writer() {
  local tries temporary pid
  for ((tries = 0; tries < 6000; tries++)); do
    for temporary in relit/.*.tmp.*; do
      pid=$(writer_of "$temporary")
      [ -e "$temporary" ] && [ "$pid" != "${1:-}" ] && kill -STOP "$pid" 2>/dev/null || continue
      [ ! -e "$temporary" ] || { echo "$pid"; return; }
      kill -CONT "$pid"
    done
    sleep 0.01
  done
  fail "no task wrote a frame within a minute"
}

variable_of() { tr '\0' '\n' <"/proc/$1/environ" | sed -n "s/^$2=//p"; }  # PID NAME

is_gone() { ! kill -0 "$1"; }

test_slurm() {
  start_cluster "$work/cluster"
  example relit.sbatch >relit.sbatch
  mkdir -p log relit
  local job killed cancelled cancelled_task drained_at
  job=$(run_example sbatch | grep -o '[0-9]*$')
  killed=$(catch_writer)
  scontrol update partitionname=all state=down  # tasks are left to start after the drain
  cancelled=$(catch_writer "$killed")
  cancelled_task=${job}_$(variable_of "$cancelled" SLURM_ARRAY_TASK_ID)
  say "slurm: job $job; drain n1, kill task ${job}_$(variable_of "$killed" SLURM_ARRAY_TASK_ID)," \
    "cancel task $cancelled_task"
  scontrol update nodename=n1 state=drain reason=test
  drained_at=$(date +%s)
  kill -KILL "$killed"
  scancel "$cancelled_task"
  wait_until 20 "process $cancelled to end" is_gone "$cancelled"
  [ -z "$(find relit -name ".*-$cancelled-*")" ] || fail "a cancelled task has left a temporary"
  sleep 2  # Slurm tells times in seconds
  scontrol update partitionname=all state=up
  wait_until 120 "job $job to end" job_has_ended "$job"
  check_states "$job"
  check_nodes_after "$job" "$drained_at"
  check_resources log
  is_shot_complete && fail "a killed and a cancelled task lost no frame"
  say "slurm: $(frames_done) of 48 frames after the first run; the same command again"

  local before
  before=$(complete_frames)
  job=$(run_example sbatch | grep -o '[0-9]*$')
  wait_until 120 "job $job to end" job_has_ended "$job"
  check_all_completed "$job"
  check_kept "$before"
  check_shot "slurm"
}

# On the cluster of test_slurm, both of whose nodes are used again.
test_chunks() {
  scontrol update nodename=n1 state=resume
  example shot.sbatch >shot.sbatch
  ssdo shot/shot.####.exr -o whole/relit.####.exr --env sky.exr --shot 2 --create-dirs
  diff -q whole/relit.1024.exr local/relit.1024.exr >/dev/null && fail "frames around change nothing"
  local size job
  rm log/*.json
  for size in 1 5 48; do
    rm -r relit
    job=$(bash -euo pipefail -c "$(example shot | sed "s/:5/:$size/")" | grep -o '[0-9]*$')
    wait_until 180 "job $job to end" job_has_ended "$job"
    check_all_completed "$job"
    diff -r whole relit || fail "chunks of $size: not the files of one local run"
    say "slurm: chunks of $size frames have the bits of one local run"
  done
  stop_cluster
}

# Statistics of chunks of one shot are joined in the order of its frames.
test_statistics() {
  command -v jq >/dev/null || { say "jq is missing: statistics are not joined"; return; }
  run_example stats
  [ "$(jq '[.[].frame] == [range(1001; 1049) | (., ., .)]' shot.json)" = true ] ||
    fail "the statistics of the chunks are not those of the shot, three times"
  say "statistics: $(jq length shot.json) objects joined"
}

test_parallel() {
  rm -r relit
  mkdir relit
  run_example parallel &
  local runner=$! killed
  killed=$(catch_writer)
  kill -KILL "$killed"
  ! wait "$runner" || fail "parallel: a killed task is no failure"
  say "parallel: killed process $killed; $(frames_done) of 48 frames; the same command again"
  run_example parallel
  check_shot "parallel"
}

test_make() {
  rm -r relit
  mkdir relit
  example Makefile | sed 's/^        /\t/' >Makefile
  run_example make >make.log 2>&1 &
  local runner=$! caught
  caught=$(catch_writer)
  kill -KILL "$caught"
  ! wait "$runner" || fail "make: a killed task is no failure"
  say "make: killed process $caught; $(frames_done) of 48 frames; the same command again"
  setsid make -j 2 >make.log 2>&1 &
  runner=$!
  caught=$(catch_writer)
  kill -TERM -- "-$runner"
  kill -CONT "$caught"
  ! wait "$runner" || fail "make: an interrupted run is no failure"
  [ -z "$(find relit -name '.*')" ] || fail "make: an interrupted run has left a temporary"
  say "make: interrupted; $(frames_done) of 48 frames; the same command again"
  run_example make >make.log 2>&1 || { cat make.log; fail "make: the last run failed"; }
  check_shot "make"
}

# What a machine that is gone has left is not for ssdo to judge: the man page has a command.
test_leftovers_of_other_machines() {
  local left=relit/.relit.1003.ssdo-00000000-7-00000000.tmp.exr
  touch -d '1 day ago' "$left"
  ssdo shot/shot.####.exr -o relit/relit.####.exr --frames 1003 --overwrite --env sky.exr
  [ -e "$left" ] || fail "a temporary of another machine was removed"
  run_example leftovers
  check_shot "leftovers"
}

# Tasks that were stopped and not yet killed would stay.
end() {
  local code=$? temporary
  [ "$code" -eq 0 ] || [ ${#daemons[@]} -eq 0 ] || show_cluster_logs || true
  [ ! -e "$work/failure" ] || cat "$work/failure"
  stop_cluster
  for temporary in "$work"/relit/.*.tmp.*; do
    [ ! -e "$temporary" ] || kill -KILL "$(writer_of "$temporary")" 2>/dev/null || true
  done
  kill $(jobs -p) 2>/dev/null || true
  cd /
  rm -rf "$work"
}

tool=$(realpath -m "${1:-$root/build/release/ssdo}")
check_machine
work=$(mktemp -d)
chmod 755 "$work"  # munged refuses a socket that others could not reach
trap end EXIT
trap 'exit 143' INT TERM
cd "$work"
mkdir bin
ln -s "$tool" bin/ssdo
export PATH=$work/bin:$PATH
make_shot
run_locally
say "local run: $(ls local/*.exr | wc -l) frames"
test_slurm
test_chunks
test_statistics
test_parallel
test_make
test_leftovers_of_other_machines
say "all passed"
