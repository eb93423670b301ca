# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: inputs that vanish, shrink or change while they are read, and files that are none.

# draw_delay: sets drawn to microseconds within a run; mostly few, since it reads first.
draw_delay() {
  draw "$job_us"
  draw $((drawn + 1))
}

# disturb HOW FILE DELAY
disturb() {
  pause "$3"
  case $1 in
    removed) rm -f "$2" ;;
    emptied) : >"$2" ;;
    halved) truncate --size="$(($(stat --format=%s "$2") / 2))" "$2" ;;
    renamed) mv "$given/other.exr" "$2" ;;
    rewritten) cat "$given/other.exr" >"$2" ;;
  esac
}

# is_whole FILE: all its pixels can be read, whatever it was made from.
is_whole() { "$tool" compare "$1" "$1" >/dev/null 2>&1 || complain "$1 cannot be read"; }

# test_disturbed HOW FILE ARGUMENTS...: FILE is one of the inputs that are named. What is moved over
# a frame is $given/other.exr, of which an undisturbed run has made $given/of_other.exr.
test_disturbed() {
  new_case
  draw_delay
  disturb "$1" "$2" "$drawn" &
  local other=$!
  run "${@:3}" -q -o a.exr
  wait "$other"
  ended "0 3"
  holds a.exr
  if [ "$code" -eq 0 ]; then
    case $1 in
      rewritten) is_whole a.exr ;;  # it may have read some of each
      renamed) cmp -s a.exr "$given/of_other.exr" || are new a.exr ;;
      *) are new a.exr ;;
    esac
    finished=$((finished + 1))
  else
    are none a.exr
  fi
}

test_changing_inputs() {
  local finished=0 i count=$((runs / 4)) file=$given/shot.1001.exr
  "$tool" "$input/shot.1002.exr" -q --env "$input/sky.exr" -o "$given/of_other.exr"
  for ((i = 0; i < count; i++)); do
    cp "$input/sky.exr" "$given/sky.exr"
    cp "$frame" "$file"
    cp "$input/shot.1002.exr" "$given/other.exr"
    case $((i % 2)) in
      0)
        pick removed emptied halved renamed rewritten
        test_disturbed "$picked" "$file" "$file" --env "$input/sky.exr"
        ;;
      1)
        pick removed emptied halved
        test_disturbed "$picked" "$given/sky.exr" "$frame" --env "$given/sky.exr"
        ;;
    esac
  done
  say "inputs that change: $count runs, $finished finished, the others refused; every output of one input"
}

# Frames and other pictures that go between two frames. The frames of a shot do without one that is
# gone: they are compared with none.
test_changing_shots() {
  local i name finished=0 count=$((runs / 8)) kind victim
  local whole=$work/shots
  local -A flags=([alone]="" [also]="--also $given/shot.1003.exr" [shot]="--shot 1")
  local render=("$tool" "$given/shot.####.exr" --frames 1001-1002 -q --env "$input/sky.exr")
  mkdir "$whole"
  cp "$input"/shot.*.exr "$given"
  for kind in alone also; do "${render[@]}" ${flags[$kind]} -o "$whole/$kind.####.exr"; done
  for ((i = 0; i < count; i++)); do
    rm -rf "$given"/*
    cp "$input"/shot.*.exr "$given"
    new_case
    pick "${!flags[@]}"
    kind=$picked
    pick "$given"/shot.*.exr
    victim=$picked
    pick removed emptied halved
    draw_delay
    disturb "$picked" "$victim" "$drawn" &
    local other=$!
    run "${render[@]:1}" ${flags[$kind]} -o "$kind.####.exr"
    wait "$other"
    ended "0 3"
    for name in "$kind".*.exr; do
      [ -e "$name" ] || continue
      is_whole "$name"
      [ "$kind" = shot ] || cmp -s "$name" "$whole/$name" || complain "$name is not as undisturbed"
    done
    holds "$kind".100{1,2}.exr
    [ "$code" -ne 0 ] || finished=$((finished + 1))
  done
  rm -rf "$given"/*
  say "shots that change: $count runs, $finished finished, the others refused; every output whole"
}

# test_disturbed_report HOW FILE CODES REPORT ARGUMENTS...: REPORT is what the run makes.
test_disturbed_report() {
  new_case
  draw_delay
  disturb "$1" "$2" "$drawn" &
  local other=$!
  run "${@:5}"
  wait "$other"
  ended "$3"
  holds "$4"
  [ "$code" -eq 0 ] || return 0
  [ -s "$4" ] || complain "$4 is missing"
  finished=$((finished + 1))
}

test_changing_bench() {
  local finished=0 i count=$((runs / 8)) job_us how
  local command=(bench "$given/frame.exr" -q --methods sao --env "$given/sky.exr" --report a.json)
  for ((i = 0; i < count; i++)); do
    cp "$frame" "$input/sky.exr" "$given"
    cp "$new/a.exr" "$given/truth.exr"
    cp "$tiny" "$given/other.exr"
    new_case
    # It reads in the first of the time that it takes.
    [ "$i" -gt 0 ] || job_us=$(($(microseconds run "${command[@]}" --truth "$given/truth.exr:ao") / 20))
    pick removed emptied halved renamed rewritten
    how=$picked
    pick frame sky truth
    test_disturbed_report "$how" "$given/$picked.exr" "0 3 4" a.json "${command[@]}" --truth "$given/truth.exr:ao"
  done
  say "bench with inputs that change: $count runs, $finished finished, the others refused"
}

test_changing_compare() {
  local finished=0 i count=$((runs / 4)) job_us how
  local command=(compare "$given/a.exr:ao" "$given/b.exr:ao" --mask "$given/mask.exr:ao" --diff d.exr)
  for ((i = 0; i < count; i++)); do
    cp "$new/a.exr" "$given/a.exr"
    cp "$old/a.exr" "$given/b.exr"
    cp "$new/a.exr" "$given/mask.exr"
    cp "$tiny" "$given/other.exr"
    new_case
    [ "$i" -gt 0 ] || job_us=$(microseconds run "${command[@]}")
    [ "$i" -gt 0 ] || mv d.exr "$new"
    pick removed emptied halved renamed rewritten
    how=$picked
    pick a b mask
    test_disturbed_report "$how" "$given/$picked.exr" "0 3 4" d.exr "${command[@]}"
    [ "$code" -ne 0 ] || [ "$how" = rewritten ] || are new d.exr
  done
  say "compare with inputs that change: $count runs, $finished finished, the others refused"
}

# refuse_input CODES ARGUMENTS...: no output is made.
refuse_input() {
  new_case
  run "${@:2}"
  refused "$1" "" a.exr
  count=$((count + 1))
}

# Where a file is expected: what is none, in every option that names one. Text may come from a pipe.
test_odd_inputs() {
  local odd option count=0
  mkfifo "$given/pipe.exr"
  mkdir "$given/folder.exr"
  : >"$given/empty.exr"
  python3 -c 'import socket, sys; socket.socket(socket.AF_UNIX).bind(sys.argv[1])' "$given/socket.exr"
  for odd in "$given"/{pipe,folder,empty,socket,none}.exr /dev/{zero,null,full} /proc/{cpuinfo,self/mem}; do
    refuse_input 3 "$odd" -q -o a.exr
    refuse_input 3 "$frame" -q -o a.exr --env "$odd"
  done
  for odd in "$given"/{pipe,folder}.exr /dev/zero /proc/self/mem; do
    refuse_input 3 info "$odd"
    refuse_input 3 compare "$odd" "$new/a.exr"
    refuse_input 3 compare "$new/a.exr" "$new/a.exr" --mask "$odd"
    refuse_input 3 bench "$tiny" -q --methods sao --truth "$odd:AO"
    refuse_input 3 "$frame" -q -o a.exr --also "$odd"
    refuse_input "3 4" "$frame" -q -o a.exr --aov "albedo=$odd:Albedo"
  done
  for odd in "$given"/{folder,socket,none}.exr /proc/self/mem; do
    refuse_input 3 "$frame" -q -o a.exr --camera "$odd"
    refuse_input 2 "$frame" -q -o a.exr --config "$odd"
    refuse_input 3 "$frame" -q -o a.png --ocio "$odd"
  done
  rm -r "$given"/*
  say "inputs that are no files: $count runs refused, none waits"
}

test_inputs() {
  local job_us
  new_case
  job_us=$(microseconds run "${job[@]}" -o a.exr)
  test_changing_inputs
  test_changing_shots
  test_changing_bench
  test_changing_compare
  rm -rf "$given"/*
  test_odd_inputs
}
