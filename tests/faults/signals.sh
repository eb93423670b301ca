# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: signals at random times.

now_us() { echo "${EPOCHREALTIME/./}"; }

# microseconds COMMAND...: how long it takes.
microseconds() {
  local start
  start=$(now_us)
  "$@"
  echo $(($(now_us) - start))
}

# start ARGUMENTS...: the tool in the background, in a process group of its own. Sets pid.
# A shell has its background jobs ignore SIGINT, which they would inherit.
start() {
  arguments=("$@")
  (as_plain_user env --default-signal setsid "$tool" "$@") >"$log.out" 2>"$log.err" </dev/null &
  pid=$!
}

# finish: waits for the tool, for a minute at most. Sets code, 124 if it hangs. The shell tells
# standard error of every process that a signal ends.
finish() {
  local end=$((SECONDS + 60))
  code=0
  while kill -0 "$pid" && [ "$SECONDS" -lt "$end" ]; do sleep 0.02; done
  kill -KILL "$pid" && code=124 && return
  wait "$pid" || code=$?
} 2>/dev/null

# deliver SIGNAL TO: to the process, to its group or twice; it may have ended.
deliver() {
  case $2 in
    process) kill "-$1" "$pid" ;;
    group) kill "-$1" -- "-$pid" ;;
    twice) kill "-$1" "$pid" && kill "-$1" "$pid" ;;
  esac || true
  [ "$1" != STOP ] || { sleep 0.1; kill -CONT "$pid"; } || true
  return 0
} 2>/dev/null

# wait_for_temporary: until the tool writes one, or has ended.
wait_for_temporary() {
  while kill -0 "$pid" && ! compgen -G '.*.ssdo-*' >/dev/null; do sleep 0.001; done
} 2>/dev/null

# leftovers: the temporaries in the folder.
leftovers() { find . -name '.*.ssdo-*.tmp.*'; }

# check_interrupted FILE...: each output is as before or new; all new if the run was done.
check_interrupted() {
  local name state
  for name in "$@"; do
    state=$(state_of "$name")
    [ "$state" = new ] || { [ "$state" = "$before" ] && [ "$code" -ne 0 ]; } || complain "$name is $state"
  done
  [ "$signal" = KILL ] || holds "$@"
}

test_signal() {
  local outputs what=("${job[@]}") longest=$job_us status
  pick frame shot
  if [ "$picked" = frame ]; then
    outputs=(a.exr a.png)
    what+=(-o a.exr -o a.png)
  else
    outputs=(relit.100{1,2,3}.exr relit.100{1,2,3}.png)
    what=("${shot[@]}" -o relit.####.exr -o relit.####.png)
    longest=$shot_us
  fi
  pick none old
  if [ "$picked" = old ]; then new_case old "${outputs[@]}"; else new_case; fi
  pick 1 2 4
  start "${what[@]}" --overwrite --threads "$picked"
  pick "$((longest * 11 / 10))" 5000
  draw "$picked"
  [ "$picked" -ne 5000 ] || wait_for_temporary
  pause "$drawn"
  pick INT INT TERM TERM HUP QUIT XCPU USR1 KILL KILL PIPE STOP
  signal=$picked
  pick process group twice
  deliver "$signal" "$picked"
  finish
  case $signal in  # SIGPIPE is ignored once the tool has begun
    STOP) status=0 ;;
    *) status=$((128 + $(kill -l "$signal"))) ;;
  esac
  [ "$code" -eq 0 ] || [ "$code" -eq "$status" ] || complain "SIG$signal: expected 0 or $status"
  check_interrupted "${outputs[@]}"
  [ "$code" -eq 0 ] && finished=$((finished + 1)) || interrupted=$((interrupted + 1))
  [ "$signal" = KILL ] || return 0
  left=$((left + $(leftovers | wc -l)))
  run "${what[@]}" --overwrite
  made "${outputs[@]}"
}

test_signals() {
  local finished=0 interrupted=0 left=0 signal i job_us shot_us
  new_case
  job_us=$(microseconds run "${job[@]}" -o a.exr -o a.png)
  shot_us=$(microseconds run "${shot[@]}" -o relit.####.exr -o relit.####.png)
  for ((i = 0; i < runs; i++)); do test_signal; done
  [ "$runs" -lt 24 ] || [ "$interrupted" -gt 0 ] || complain "no signal came in time"
  say "signals: $runs runs, $finished finished, $interrupted interrupted; every output whole;" \
    "no temporary but $left of killed runs, which the next run removed"
}
