# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: how a case is set up and run, and what must hold after it. A case runs in an empty
# folder of its own, with the outputs of two undisturbed runs to compare with: $old, which a case may
# find there, and $new, which is what it makes.

# say WORDS: a line for what is done, which begins with the faults that it had.
say() {
  local count=$((faults - faults_told))
  faults_told=$faults
  echo "[${SECONDS}s] $([ "$count" -eq 0 ] || echo "$count FAULTS: ")$*"
}

fail() {
  echo "tests/faults: $*" >&2
  exit 1
}

faults=0 faults_told=0

# complain WHAT: shows a fault of the last run, and goes on.
complain() {
  faults=$((faults + 1))
  echo "tests/faults: ${FUNCNAME[2]}: $*; ssdo ${arguments[*]} ${around:+(${around[*]}) }ended with $code:" \
    "$(head -c 300 "$log.err" | tr '\n' '|')" >&2
}

# draw N: sets drawn, 0 to N - 1. (A subshell would draw numbers that no seed repeats.)
draw() { drawn=$(((RANDOM * 32768 + RANDOM) % $1)); }

# pick WORD...: sets picked.
pick() {
  draw $#
  shift "$drawn"
  picked=$1
}

# pause MICROSECONDS
pause() { sleep "$(printf '%d.%06d' $(($1 / 1000000)) $(($1 % 1000000)))"; }

# as_plain_user COMMAND...: root would be stopped by no permission. Keeps the process id. The user is
# one of its own, so that nobody else's processes count as its.
as_plain_user() { exec setpriv --reuid=$((2000000 + $$)) --regid=nogroup --clear-groups -- "$@"; }

# What a case puts around the tool: a command that ends with the one to run.
around=()
before=none  # what the case found at its outputs: none or old

# new_case [old FILE...]: an empty folder for outputs, or one with those of an earlier run.
new_case() {
  cd "$work"
  rm -rf case
  mkdir case
  cd case
  before=none
  [ $# -gt 0 ] || return 0
  before=old
  local name
  for name in "${@:2}"; do cp "$old/$name" .; done
}

# run ARGUMENTS...: the tool, which must not hang. Sets code.
run() {
  arguments=("$@") code=0
  (as_plain_user timeout --kill-after=5 60 "${around[@]}" "$tool" "$@") \
    >"$log.out" 2>"$log.err" </dev/null || code=$?
  [ "$code" -ne 124 ] && [ "$code" -ne 137 ] || complain "hangs"
}

# ended CODES [WORDS]: the run has ended with one of these, and a failure has said why in one line.
ended() {
  [[ " $1 " = *" $code "* ]] || complain "expected to end with $1"
  [ "$code" -ne 0 ] && [ "$code" -lt 128 ] || return 0
  [ "$(wc -l <"$log.err")" -eq 1 ] && grep -q '^ssdo: ' "$log.err" || complain "expected one line"
  [ -z "${2:-}" ] || grep -qE -- "$2" "$log.err" || complain "expected a message with '$2'"
}

# state_of FILE: none, old, new or broken.
state_of() {
  local name=${1##*/}
  if [ ! -e "$1" ]; then
    echo none
  elif cmp -s "$1" "$new/$name"; then
    echo new
  elif cmp -s "$1" "$old/$name"; then
    echo old
  else
    echo broken
  fi
}

# are STATE FILE...: the outputs are all old, new or none.
are() {
  local name
  for name in "${@:2}"; do
    [ "$(state_of "$name")" = "$1" ] || complain "$name is $(state_of "$name") instead of $1"
  done
}

# holds FILE...: these files at most stand in the folder: no temporary, nothing else.
holds() {
  local name others
  others=$(for name in * .[!.]*; do [ ! -e "$name" ] || echo "$name"; done | grep -vxF -f <(printf '%s\n' "$@")) || true
  [ -z "$others" ] || complain "left behind: $others"
}

# refused CODES WORDS FILE...: the run has failed, and the outputs are as before.
refused() {
  ended "$1" "$2"
  are "$before" "${@:3}"
  holds "${@:3}"
}

# made FILE...: the run is done, and the outputs are those of an undisturbed run.
made() {
  ended 0
  are new "$@"
  holds "$@"
}

# made_or_refused CODES WORDS FILE...
made_or_refused() {
  if [ "$code" -eq 0 ]; then made "${@:3}"; else refused "$@"; fi
}
