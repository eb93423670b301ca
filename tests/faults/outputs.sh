# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: links, devices and folders in the place of outputs, and rivals for one output.

# A link is written through, and only with --overwrite.
test_links() {
  new_case
  mkdir far
  cp "$old/a.exr" far/a.exr
  ln -s far/a.exr a.exr
  run "${job[@]}" -o a.exr
  ended 5 "a.exr: exists"
  are old far/a.exr
  run "${job[@]}" -o a.exr --overwrite
  ended 0
  are new far/a.exr
  [ -L a.exr ] || complain "the link was replaced"
  new_case
  mkdir far
  ln -s far/a.exr a.exr
  run "${job[@]}" -o a.exr
  ended 5 "a.exr: is a symbolic link to 'far/a.exr', which does not exist"
  are none far/a.exr
  run "${job[@]}" -o a.exr --overwrite
  ended 0
  are new far/a.exr
  [ -L a.exr ] && [ "$(ls -A far)" = a.exr ] || complain "not made in place of the link's target"
  new_case
  ln -s . here
  ln -s "$frame" input.exr
  ln "$frame" "$work/case/hard.exr"
  ln -s loop.exr loop.exr
  ln -s "$small" small
  local name
  for name in input.exr hard.exr; do
    run "${job[@]}" -o "$name" --overwrite
    ended 5 "is an input"
  done
  cmp -s "$frame" hard.exr || complain "the input was changed"
  for name in here loop.exr; do
    run "${job[@]}" --save "ao=$name/" --overwrite
    ended "2 5"
  done
  run "${job[@]}" -o loop.exr --overwrite
  ended 5 "[lL]ink"
  rm "$small"/* -rf
  run "${job[@]}" -o small/a.exr
  ended 0
  are new "$small/a.exr"
  [ "$(ls -A "$small")" = a.exr ] || complain "left behind on another disk"
  rm -f hard.exr
  say "links: written through with --overwrite only; inputs stay"
}

# The other names of an output keep what it was.
test_hard_link() {
  new_case old a.exr
  ln a.exr other.exr
  run "${job[@]}" -o a.exr --overwrite
  ended 0
  are new a.exr
  cmp -s other.exr "$old/a.exr" || complain "the other name of the output has changed"
}

test_odd_outputs() {
  local odd more
  new_case
  mkfifo pipe.exr
  mkdir folder.exr
  python3 -c 'import socket; socket.socket(socket.AF_UNIX).bind("socket.exr")'
  ln -s /dev/null null.exr
  ln -s /dev/full full.exr
  for odd in pipe.exr folder.exr socket.exr null.exr full.exr pipe.exr/a.exr; do
    for more in "" --overwrite; do
      run "${job[@]}" -o "$odd" $more
      ended 5
      run compare "$new/a.exr" "$old/a.exr" --diff "$odd" $more
      ended 5
    done
    run "${job[@]}" -o a.exr --stats "$odd"
    ended 5
    are none a.exr
  done
  [ "$(ls -A | wc -l)" -eq 5 ] || complain "left behind: $(ls -A)"
  say "outputs that are no files: refused"
}

# race COUNT OPTIONS...: so many processes for one output. Sets done and others, as many as ended
# with 0 and with 5.
race() {
  local count=$1 i pids=()
  arguments=("${job[@]}" -o a.exr -o a.png "${@:2}")
  for ((i = 0; i < count; i++)); do
    (as_plain_user timeout 60 "$tool" "${arguments[@]}") >"$log.$i" 2>&1 </dev/null &
    pids+=($!)
  done
  done=0 others=0
  for i in "${!pids[@]}"; do
    code=0
    wait "${pids[$i]}" || code=$?
    cp "$log.$i" "$log.err"
    ended "0 5" "exists|appeared while"
    if [ "$code" -eq 0 ]; then done=$((done + 1)); else others=$((others + 1)); fi
  done
}

test_rivals() {
  local count i done others
  for count in 2 8; do
    for ((i = 0; i < 1 + runs / 40; i++)); do
      new_case
      race "$count"
      [ "$done" -eq 1 ] || complain "$done of $count have made the same output"
      [ "$(state_of a.exr)" != broken ] && [ "$(state_of a.png)" != broken ] || complain "broken output"
      holds a.exr a.png
      new_case old a.exr
      race "$count" --overwrite
      [ "$done" -eq "$count" ] || complain "$others of $count rivals failed"
      made a.exr a.png
      new_case old a.exr
      race "$count" --skip-existing
      [ "$done" -eq "$count" ] || complain "$others of $count rivals failed"
      made a.exr a.png
    done
  done
  say "rivals: 2 and 8 for one output; one makes it, or all with --overwrite"
}

test_outputs() {
  test_links
  test_hard_link
  test_odd_outputs
  test_rivals
}
