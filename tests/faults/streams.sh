# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: standard output and standard error that are closed, full or without a reader.

# run_with REDIRECTIONS ARGUMENTS...: as run; what is not redirected goes to the log.
run_with() {
  arguments=("${@:2}" "$1") code=0
  eval '(as_plain_user timeout --kill-after=5 60 "$tool" "${@:2}") >"$log.out" 2>"$log.err" </dev/null '"$1" ||
    code=$?
}

test_lost_output() {
  local words
  local speakers=(
    "info $frame" "info $frame --json" "compare $new/a.exr $old/a.exr" "bench $tiny -q --methods sao"
    "compare $new/a.exr $old/a.exr --json" "--help" "--help-all" "--version" "--list-methods"
    "--completions bash" "--completions zsh"
  )
  for words in "${speakers[@]}"; do
    new_case
    run_with '>/dev/full' $words
    ended 5 "standard output cannot be written"
    run_with '> >(true)' $words
    ended 0
    [ ! -s "$log.err" ] || complain "a reader that has gone is no error"
    run_with '>&- 2>&-' $words
    ended 0
  done
  new_case
  for words in '>&- 2>&-' '2>&-' '2>/dev/full' '2> >(true)' '> >(true)' '<&- >&- 2>&-'; do
    run_with "$words" "${job[0]}" --env "$input/sky.exr" -v -o a.exr -o a.png
    ended 0
    are new a.exr a.png
    holds a.exr a.png
    rm a.*
    run_with "$words" "${job[@]}" -o none/a.exr
    [ "$code" -eq 5 ] || complain "expected 5"
    holds none
  done
  run_with '>/dev/full' "${job[@]}" -o a.exr --progress tractor
  ended 0
  are new a.exr
  say "lost output: ${#speakers[@]} commands and the main job end as they should"
}

# fill FIFO: opens it as descriptor 9 and fills it.
fill() {
  mkfifo "$1"
  exec 9<>"$1"
  dd if=/dev/zero of=/proc/self/fd/9 oflag=nonblock bs=4096 2>/dev/null || true
}

# Who says nothing needs no reader; who does waits for it, and can be ended.
test_full_pipe() {
  new_case
  fill "$work/pipe"
  run_with '>&9 2>&9' "${job[@]}" -o a.exr -o a.png
  ended 0
  are new a.exr a.png
  code=0
  arguments=(info)
  (as_plain_user timeout 1 "$tool" info "$frame") >&9 2>"$log.err" || code=$?
  [ "$code" -eq 124 ] || complain "expected to wait for the reader, and to end with SIGTERM"
  (as_plain_user timeout 60 "$tool" info "$frame") >&9 2>"$log.err" &
  local writer=$!
  sleep 0.3
  code=0
  dd if="$work/pipe" bs=65536 count=1 2>/dev/null | tr -d '\0' >"$log.out"
  wait "$writer" || code=$?
  ended 0
  exec 9>&-
  rm "$work/pipe"
  say "full pipe: waits where it has to"
}

test_streams() {
  test_lost_output
  test_full_pipe
}
