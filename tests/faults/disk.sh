# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: disks that are full, files that may not grow, and places that may not be written.

# leave BYTES: fills the small disk, whose pages have 4 KiB, up to these.
leave() {
  rm -f "$small/filler"
  local bytes=$(($(stat --file-system --format='%a * %S' "$small") - $1))
  [ "$bytes" -le 0 ] || fallocate --length "$bytes" "$small/filler"
}

# sizes_below FILE: from none to just too little for FILE, in bytes.
sizes_below() {
  local pages=$((($(stat --format=%s "$1") + 4095) / 4096))
  printf '%s\n' 0 $((pages / 2)) $((pages - 1)) | sort -nu | awk '{ print 4096 * $1 }'
}

# in_small: the case takes place on the small disk.
in_small() {
  rm -rf "$small"/*
  mkdir "$small/case"
  [ -z "$(ls)" ] || cp ./* "$small/case"
  cd "$small/case"
}

# what each kind of output is asked for by
declare -A outputs_of=(
  [a.exr]="-o a.exr" [a.png]="-o a.png" [a.jpg]="-o a.jpg" [a.tif]="-o a.tif"
  [ao.exr]="--save ao=ao.exr"
)

test_full_disk() {
  local name size start runs=0
  for name in "${!outputs_of[@]}"; do
    for size in $(sizes_below "$new/$name"); do
      # Pictures take the same way, whether there is one or not.
      for start in old $([ "$name" != a.exr ] || echo none); do
        if [ $start = old ]; then new_case old "$name"; else new_case; fi
        in_small
        leave "$size"
        run "${job[@]}" --overwrite ${outputs_of[$name]}
        refused 5 "cannot be written.*No space left" "$name"
        runs=$((runs + 1))
      done
    done
    leave $(($(stat --format=%s "$new/$name") + 8192))
    run "${job[@]}" --overwrite ${outputs_of[$name]}
    made "$name"
  done
  say "full disk: $runs runs with too little room; every one refused, what was there is whole"
}

# Two outputs of which one fits: neither is renamed.
test_room_for_one() {
  new_case old a.exr a.png
  in_small
  leave $(($(stat --format=%s "$new/a.png") + 8192))
  run "${job[@]}" --overwrite -o a.png -o a.exr
  refused 5 "a.exr: cannot be written" a.png a.exr
  run "${job[@]}" --overwrite -o a.exr -o a.png
  refused 5 "a.exr: cannot be written" a.png a.exr
  # The statistics come after the frames, which stay.
  new_case
  in_small
  echo '[]' >stats.json
  leave $((($(stat --format=%s "$new/a.exr") + 4095) / 4096 * 4096))
  run "${job[@]}" -o a.exr --stats stats.json
  ended 5 "stats.json: .*(No space|could not be written|cannot be written)"
  are new a.exr
  [ "$(cat stats.json)" = "[]" ] || complain "the statistics are neither old nor new"
  holds a.exr stats.json
  say "room for some outputs of a run only: none appears in part"
}

test_full_disk_of_other_commands() {
  local kind size
  for size in 0 4096 65536; do
    new_case old d.exr
    in_small
    leave "$size"
    run compare "$new/a.exr" "$old/a.exr" --diff d.exr --overwrite
    refused 5 "d.exr: cannot be written" d.exr
  done
  new_case
  in_small
  echo old | tee r.html >r.csv
  leave 8192
  run bench "$tiny" -q --methods sao --report r.csv --report r.html --overwrite
  ended 5 "r.html: cannot be written"
  [ "$(cat r.csv r.html | sort -u)" = old ] || complain "a report is neither old nor new"
  holds r.csv r.html
  say "full disk: compare and bench refused, what was there is whole"
}

test_file_size_limit() {
  local name size runs=0
  for name in "${!outputs_of[@]}"; do
    for size in $(($(stat --format=%s "$new/$name") / 2)) $(($(stat --format=%s "$new/$name") - 1)); do
      new_case old "$name"
      around=(prlimit --fsize="$size")
      run "${job[@]}" --overwrite ${outputs_of[$name]}
      around=()
      refused 5 "cannot be written: File too large" "$name"
      runs=$((runs + 1))
    done
  done
  say "file size limit: $runs runs refused, what was there is whole"
}

test_places() {
  mkdir -p "$work/places"/{sealed,dark,blind,sticky}
  local places=$work/places
  cp "$old/a.exr" "$places/sealed"
  cp "$old/a.exr" "$places/sticky"
  new_case
  chmod 555 "$places/sealed"
  chmod 666 "$places/dark"
  chmod 333 "$places/blind"
  chmod 1777 "$places/sticky"
  run "${job[@]}" -o "$places/sealed/b.exr"
  ended 5 "cannot be written to: Permission denied"
  run "${job[@]}" -o "$places/dark/b.exr"
  ended 5 "Permission denied"
  run "${job[@]}" -o "$places/sealed/no/b.exr" --create-dirs
  ended 5 "Permission denied"
  run "${job[@]}" -o "$places/sealed/a.exr" --overwrite
  ended 5 "cannot be written to: Permission denied"
  run "${job[@]}" -o "$places/sticky/a.exr" --overwrite
  ended 5 "a.exr: .*Operation not permitted"
  are old "$places/sealed/a.exr" "$places/sticky/a.exr"
  run "${job[@]}" -o "$places/blind/a.exr"
  ended 0
  are new "$places/blind/a.exr"
  run "${job[@]}" -o "$readonly/b.exr"
  ended 5 "Read-only file system"
  run "${job[@]}" -o "$readonly/a.exr" --overwrite
  ended 5 "Read-only file system"
  run "${job[@]}" -o /proc/a.exr
  ended 5
  chmod 777 "$places"/*
  [ -z "$(find "$places" "$readonly" -name '.*tmp*')" ] || complain "a temporary is left"
  rm -rf "$places"
  new_case old a.exr
  chmod 444 a.exr
  run "${job[@]}" --overwrite -o a.exr
  refused 5 "cannot be replaced: Permission denied" a.exr
  new_case
  cp "$frame" "$given/locked.exr"
  chmod 000 "$given/locked.exr"
  run "$given/locked.exr" -q -o a.exr
  refused 3 "Permission denied" a.exr
  run info "$given/locked.exr"
  refused 3 "Permission denied" a.exr
  rm "$given/locked.exr"
  say "places: read-only, sealed, dark, sticky and write-protected ones refused, a blind one written to"
}

test_disk() {
  test_full_disk
  test_room_for_one
  test_full_disk_of_other_commands
  test_file_size_limit
  test_places
}
