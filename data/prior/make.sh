#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# make.sh WORK SSDO FRAMES [OUT]: builds the generator in the folder WORK, makes FRAMES frames and
# their inputs with the binary SSDO, 100 at a time, then trains and writes the weights to OUT
# (WORK). What exists is kept: a run that was stopped goes on where it was, and a larger FRAMES
# adds to what there is.
set -e
work=$1 ssdo=$2 frames=$3
here=$(cd "$(dirname "$0")" && pwd)
export SSDO_THREADS=1 PYTHONPATH="$here"
mkdir -p "$work/frames" "$work/tool" "$work/cache"
if [ ! -x "$work/generate" ]; then
  g++ -std=c++20 -O2 -march=native "$here"/generator/*.cpp -o "$work/generate" \
    -lembree3 -lOpenImageIO -lOpenImageIO_Util
fi
[ -f "$work/linear.exr" ] || /usr/bin/python3 "$here/linear_map.py" "$work/linear.exr"

# What the tool knows of the frames $1 to $2, beyond the border extended and open.
run() {
  first=$1 last=$2 name=$3
  shift 3
  "$ssdo" "$work/frames/frame_#####.exr" --frames "$first-$last" -o "$work/tool/${name}_#####.exr" \
    --compression none --on-error continue --skip-existing -q --env-up z --prior rules "$@" || true
}
first=0
while [ "$first" -lt "$frames" ]; do
  last=$((first + 99))
  [ "$last" -lt "$frames" ] || last=$((frames - 1))
  cache=$(printf '%s/cache/%05d_%05d.npz' "$work" "$first" "$last")
  if [ ! -f "$cache" ]; then
    "$work/generate" "$work/frames" "$first" $((last - first + 1))
    run "$first" "$last" far --radius inf --products ao,guessed,bent,direct --env "$work/linear.exr"
    run "$first" "$last" far_open --radius inf --products ao --offscreen open
    run "$first" "$last" near --radius 1 --products ao,guessed,bent
    run "$first" "$last" near_open --radius 1 --products ao --offscreen open
    /usr/bin/python3 "$here/dataset.py" "$work" "$first" "$last" "$cache"
  fi
  first=$((last + 1))
done

out=${4:-$work}
/usr/bin/python3 "$here/train.py" "$work" "$out"
/usr/bin/python3 "$here/vectors.py" "$out/prior.bin" "$here/../room_corner.exr" "$out/vectors.txt"
