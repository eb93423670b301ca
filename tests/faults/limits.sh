# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: too little memory, too few open files, too few threads.

# The loader has its own words, before the tool starts.
was_loaded() { [ "$code" -ne 127 ] || ! grep -q "error while loading shared libraries" "$log.err"; }

# count_outcome: good counts the runs that are done, bad those that are refused.
count_outcome() {
  if [ "$code" -eq 0 ]; then good=$((good + 1)); else bad=$((bad + 1)); fi
}

test_address_space() {
  local mib threads good=0 bad=0
  for threads in 1 4; do
    for ((mib = 64; mib < 760; mib += mib < 320 ? 32 : 128)); do
      new_case old a.exr a.png
      around=(prlimit --as=$((mib << 20)))
      run "${job[@]}" --overwrite -o a.exr -o a.png --threads "$threads"
      around=()
      was_loaded || continue
      made_or_refused 1 "memory|threads" a.exr a.png
      count_outcome
      new_case old a.exr
      draw 4096
      around=(prlimit --as=$(((mib << 20) + 4096 * drawn)))
      run "${job[@]}" --overwrite -o a.exr --threads "$threads"
      around=()
      was_loaded || continue
      made_or_refused 1 "memory|threads" a.exr
      count_outcome
    done
  done
  [ "$good" -gt 0 ] && [ "$bad" -gt 0 ] || complain "$good runs made, $bad refused"
  say "address space: $good runs made what they should, $bad refused for want of memory"
}

# make_group BYTES: a control group for memory, of version 1 or 2. Fails where there may be none.
make_group() {
  local limit=memory.max swap=memory.swap.max
  group=/sys/fs/cgroup/ssdo-faults-$$
  [ ! -d /sys/fs/cgroup/memory ] || group=/sys/fs/cgroup/memory/ssdo-faults-$$ limit=memory.limit_in_bytes
  mkdir "$group" && echo "$1" >"$group/$limit" && [ -w "$group/cgroup.procs" ] || return 1
  [ ! -e "$group/$swap" ] || echo 0 >"$group/$swap"
} 2>/dev/null

# need_group BYTES WHAT: makes the group, or says that WHAT is left out.
need_group() {
  make_group "$1" && return
  drop_group
  say "$2: no control group can be made here; left out"
  return 1
}

drop_group() { rmdir /sys/fs/cgroup/{,memory/}ssdo-faults-$$ 2>/dev/null || true; }

# run_in_group ARGUMENTS...: as run, in the control group.
run_in_group() {
  arguments=("$@") code=0
  (echo "$BASHPID" >"$group/cgroup.procs" && as_plain_user timeout --foreground 60 "$tool" "$@") \
    >"$log.out" 2>"$log.err" </dev/null || code=$?
} 2>/dev/null

# start_in_group ARGUMENTS...: as start, in the control group, and the first there to be killed.
start_in_group() {
  arguments=("$@")
  (echo "$BASHPID" >"$group/cgroup.procs" && echo 1000 >/proc/self/oom_score_adj &&
    as_plain_user "$tool" "$@") >"$log.out" 2>"$log.err" </dev/null &
  pid=$!
}

# take_memory BYTES: by a process of the control group, which then ends, or is killed as well.
take_memory() {
  (echo "$BASHPID" >"$group/cgroup.procs" && head -c "$1" /dev/zero | tail -c "$1" >/dev/null) || true
}

test_control_group() {
  local mib group good=0 killed=0 bad=0 left=0
  for mib in 8 12 16 24 32 48 64 128; do
    need_group $((mib << 20)) "control group" || return 0
    new_case old a.exr a.png
    run_in_group "${job[@]}" --overwrite -o a.exr -o a.png
    if [ "$code" -eq 137 ]; then
      killed=$((killed + 1))
      are old a.exr a.png
    else
      made_or_refused "1 2" "memory" a.exr a.png  # 2: pictures are not made in bands
      count_outcome
    fi
    left=$((left + $(leftovers | wc -l)))
    run "${job[@]}" --overwrite -o a.exr -o a.png
    made a.exr a.png
    drop_group
  done
  [ "$killed" -gt 0 ] || complain "no run was killed for want of memory"
  say "control group: $good made, $bad refused, $killed killed; the next run removed $left temporaries"
}

# The tool stops when its first temporary is there, and another process of its group takes what
# memory is left to both.
test_killed_while_writing() {
  local group i killed=0 left=0 signal=KILL
  for i in 1 2 3 4; do
    need_group $((256 << 20)) "killed while it writes" || return 0
    new_case old a.exr a.png
    start_in_group "${job[@]}" --overwrite -o a.exr -o a.png
    wait_for_temporary
    {
      kill -STOP "$pid" || true
      take_memory $((240 << 20))
      kill -CONT "$pid" || true
      finish
    } 2>/dev/null  # on which the shell tells what was killed
    if [ "$code" -eq 137 ]; then
      killed=$((killed + 1))
      check_interrupted a.exr a.png  # one may be in its place already
      left=$((left + $(leftovers | wc -l)))
    else
      made a.exr a.png
    fi
    run "${job[@]}" --overwrite -o a.exr -o a.png
    made a.exr a.png
    drop_group
  done
  [ "$left" -gt 0 ] || complain "no run was killed while it wrote"
  say "killed for want of memory while it writes: $killed of 4; the next run removed $left temporaries"
}

test_open_files() {
  local most good=0 bad=0
  for most in 3 4 5 6 7 8 10 12 16 20; do
    new_case old a.exr a.png
    around=(prlimit --nofile="$most")
    run "${job[@]}" --overwrite -o a.exr -o a.png --stats stats.json
    around=()
    was_loaded || continue
    rm -f stats.json
    made_or_refused "1 3 5" "" a.exr a.png
    count_outcome
  done
  say "open files: $good runs made what they should, $bad refused"
}

test_threads() {
  local most good=0 bad=0
  for most in 1 2 3 4 5 6 7 8 9 10 11 12 14 16 20; do
    new_case old a.exr a.png
    around=(prlimit --nproc="$most")
    run "${job[@]}" --overwrite -o a.exr -o a.png --threads 4
    around=()
    made_or_refused 1 "threads" a.exr a.png
    count_outcome
    around=(prlimit --nproc="$most")
    run compare "$new/a.exr" "$old/a.png:R" --json
    around=()
    ended "0 1 4"
  done
  [ "$good" -gt 0 ] && [ "$bad" -gt 0 ] || complain "$good runs made, $bad refused"
  say "threads: $good runs made what they should, $bad refused"
}

test_limits() {
  test_address_space
  test_control_group
  test_killed_while_writing
  test_open_files
  test_threads
}
