# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: system calls that fail, one at a time, as on failing disks and network file systems.
# strace(1) makes them fail.

# with_failing CALLS ERROR WHICH ARGUMENTS...: as run.
with_failing() {
  around=(strace --follow-forks --quiet=all --output=/dev/null --trace="$1" --inject="$1:error=$2:when=$3")
  run "${@:4}"
  [ "$code" -ne 0 ] || around=()
}

# calls_of CALLS ARGUMENTS...: how many a run makes.
calls_of() {
  around=(strace --follow-forks --quiet=all --output="$work/calls" --trace="$1")
  : >"$work/calls"
  run "${@:2}"
  around=()
  grep -c "(" "$work/calls" || true
}

# What cannot be renamed stays as it was; the outputs before it are new.
test_renaming() {
  local options
  for options in "" --overwrite; do
    new_case
    with_failing rename,renameat2 EACCES 1 "${job[@]}" $options -o a.exr -o a.png
    around=()
    refused 5 "a.exr: cannot be written: Permission denied" a.exr a.png
    with_failing rename,renameat2 EACCES 2 "${job[@]}" $options -o a.exr -o a.png
    around=()
    ended 5 "a.png: cannot be written: Permission denied"
    are new a.exr
    are none a.png
    holds a.exr
  done
  new_case
  with_failing renameat2 EINVAL 1+ "${job[@]}" -o a.exr -o a.png
  around=()
  made a.exr a.png
  say "calls: rename fails; file systems that cannot rename without replacing are written to"
}

# test_no_thread_in WHAT FILES ARGUMENTS...: the first, second... thread does not start, alone or with all
# after it. FILES is what the run makes.
test_no_thread_in() {
  local i which count good=0 bad=0
  new_case
  count=$(calls_of clone3 "${@:3}")
  for ((i = 1; i <= count; i++)); do
    for which in "$i" "$i+"; do
      new_case
      with_failing clone3 EAGAIN "$which" "${@:3}"
      made_or_refused 1 thread $2
      around=()
      count_outcome
    done
  done
  [ "$good" -gt 0 ] && [ "$bad" -gt 0 ] || complain "$good runs made, $bad refused"
  say "calls: clone3 fails (EAGAIN) in $1: $good runs made what they should, $bad refused"
}

# No pictures: where the last of the threads fails alone that log4cplus starts while it is loaded, with which
# OpenImageIO is linked, it waits for ever. test_threads has them with a limit that stays.
test_no_thread() {
  test_no_thread_in "a frame" a.exr "${job[@]}" --threads 4 -o a.exr
  test_no_thread_in "a shot" "relit.1001.exr relit.1002.exr relit.1003.exr" "${shot[@]}" --threads 2 -o relit.####.exr
}

# test_each_of CALLS MOST ERROR...: up to MOST of the calls, at random if there are more; then not of those
# that every run makes until main() has begun: while libraries are loaded, OpenImageIO's ends in a segmentation
# fault where it gets no memory.
test_each_of() {
  local calls=$1 most=$2 count start error i which good=0 bad=0
  new_case old a.exr a.png
  start=$(calls_of "$calls" --version)
  count=$(calls_of "$calls" "${job[@]}" --overwrite --threads 2 -o a.exr -o a.png)
  [ "$count" -gt 0 ] || complain "${calls%%,*} is never called"
  [ "$start" -lt "$count" ] || start=0
  for error in "${@:3}"; do
    for ((i = 1; i <= count && i <= most; i++)); do
      which=$i
      draw $((count - start))
      [ "$count" -le "$most" ] || which=$((start + 1 + drawn))
      new_case old a.exr a.png
      with_failing "$calls" "$error" "$which" "${job[@]}" --overwrite --threads 2 -o a.exr -o a.png
      if [ "$code" -ne 127 ]; then made_or_refused "1 2 3 4 5" "" a.exr a.png; fi
      around=()
      count_outcome
    done
  done
  say "calls: ${calls%%,*} fails (${*:3}), of $count: $good runs made what they should, $bad refused"
}

# A frame that its disk does not give is not damaged: --allow-partial makes no part of it.
test_failing_disk() {
  local i count=0 most=$((runs / 4))
  for ((i = 1; i <= most; i++)); do
    new_case old a.exr
    around=(strace --follow-forks --quiet=all --output=/dev/null --trace-path="$frame" --trace=pread64
      --inject="pread64:error=EIO:when=$i+")
    run "${job[@]}" --allow-partial --overwrite -o a.exr
    around=()
    made_or_refused 3 "cannot be read at byte .*: Input/output error" a.exr
    [ "$code" -eq 0 ] || count=$((count + 1))
  done
  [ "$count" -gt 0 ] || complain "no read of a frame failed"
  say "calls: pread64 of a frame fails with --allow-partial: $count of $most runs refused, the others needed no more reads"
}

# Who is ended while a disk is waited for leaves both outputs or neither: a frame is not done in part.
test_end_at_disk() {
  local i count all=0
  new_case
  count=$(calls_of fsync "${job[@]}" -o a.exr -o a.png)
  for ((i = 1; i <= count; i++)); do
    new_case
    around=(strace --follow-forks --quiet=all --output=/dev/null --trace=fsync --inject="fsync:signal=TERM:when=$i")
    run "${job[@]}" -o a.exr -o a.png
    around=()
    ended "0 143"
    [ "$(state_of a.exr)" = none ] || all=$((all + 1))
    are "$(state_of a.exr)" a.exr a.png
  done
  [ "$all" -gt 0 ] && [ "$all" -lt "$count" ] || complain "$all of $count left both outputs"
  say "calls: ended at one of $count calls of fsync: both outputs are there after $all, none after the others"
}

test_calls() {
  local most=$((runs / 8))
  test_each_of write "$most" ENOSPC EIO
  test_each_of fsync "$most" ENOSPC EDQUOT EIO
  test_each_of close "$most" ENOSPC EIO
  test_renaming
  test_end_at_disk
  test_each_of lseek "$most" EIO
  test_each_of read,pread64 "$most" EIO
  test_failing_disk
  test_each_of openat "$most" EMFILE
  test_each_of mmap,brk "$most" ENOMEM
  test_no_thread
}
