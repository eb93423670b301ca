# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: what is waited for, and what must hold of jobs and frames. In the folder of the
# shot, with the frames of a local run in local/ and those of the farm in relit/.

say() { echo "[${SECONDS}s] $*"; }

# Daemons' logs follow, and then this once more.
fail() {
  echo "tests/farm: $*" | tee ${work:+"$work/failure"} >&2
  exit 1
}

# wait_until SECONDS WHAT COMMAND...
wait_until() {
  local end=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" 2>/dev/null; do
    [ "$SECONDS" -lt "$end" ] || fail "waited in vain for $what"
    sleep 0.1
  done
}

job_has_ended() { [ -z "$(squeue --noheader --job "$1" 2>/dev/null)" ]; }

# tasks_of JOB: for each task its id, state, node and time of start, in seconds.
tasks_of() {
  scontrol show job "$1" --oneliner | while read -r line; do
    field() { sed -n "s/.* $1=\([^ ]*\).*/\1/p" <<<" $line"; }
    echo "$(field ArrayTaskId) $(field JobState) $(field NodeList) $(date -d "$(field StartTime)" +%s)"
  done
}

check_states() {
  local states
  states=$(tasks_of "$1" | cut -d' ' -f2 | sort | uniq -c | tr -s ' ' | tr '\n' ';')
  [ "$states" = " 1 CANCELLED; 8 COMPLETED; 1 FAILED;" ] ||
    fail "expected 8 completed tasks, a cancelled and a failed one, found$states"
}

check_all_completed() {
  tasks_of "$1" | grep -v COMPLETED && fail "these tasks were not completed"
  return 0
}

# check_nodes_after JOB TIME: who starts later than TIME starts on the node that is left.
check_nodes_after() {
  local id state node start later=0
  while read -r id state node start; do
    [ "$start" -gt "$(($2 + 1))" ] || continue
    [ "$node" = n2 ] || fail "task $id started on $node, which is drained"
    later=$((later + 1))
  done < <(tasks_of "$1")
  [ "$later" -gt 0 ] || fail "no task was left to start after the drain"
  [[ $(sinfo --noheader --nodes=n1 --format=%t) = drain* ]] || fail "n1 is not drained"
  say "slurm: $later tasks started on n2 after n1 was drained"
}

# check_resources FOLDER: the man page asks for 4 processors and 1 GiB, of which ssdo takes 3/4.
check_resources() {
  local found
  found=$(cat "$1"/*.json | grep -E '"(threads|mem_limit_bytes)"' | tr -d ' ,' | sort -u | tr '\n' ' ')
  [ "$found" = '"mem_limit_bytes":805306368 "threads":4 ' ] ||
    fail "expected 4 threads and 805306368 bytes in all statistics, found $found"
}

frames_done() { find relit -name 'relit.*.exr' | wc -l; }

is_shot_complete() { diff -r local relit >/dev/null; }

# The files of frames that have both, with inode and time. A task that is killed between the names of
# its two leaves one, and that frame is made again.
complete_frames() {
  local exr
  for exr in relit/relit.*.exr; do
    [ ! -e "${exr%.exr}.png" ] || stat -c '%n %i %.Y' "$exr" "${exr%.exr}.png"
  done
}

# check_kept LIST: the files of complete_frames are as they were.
check_kept() {
  local changed
  changed=$(comm -23 <(sort <<<"$1") <(complete_frames | sort))
  [ -z "$changed" ] || fail "made again, though done: $changed"
}

# check_shot NAME: every file has the bits of the local run, and there are no others.
check_shot() {
  diff -r local relit || fail "$1: not the files of the local run"
  [ -z "$(find "$work" -name '*.ssdo-*')" ] || fail "$1: temporaries are left"
  say "$1: $(frames_done) frames and as many pictures with the bits of the local run; no leftovers"
}
