#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# make.sh WORK SSDO FRAMES [OUT]: builds the generator in the folder WORK, makes FRAMES frames and
# their inputs with the binary SSDO, 100 at a time on each core, then trains and writes the weights
# to OUT (WORK). What exists is kept: a run that was stopped goes on where it was, and a larger
# FRAMES adds to what there is.
set -e
here=$(cd "$(dirname "$0")" && pwd)
export SSDO_THREADS=1 OMP_NUM_THREADS=1 PYTHONPATH="$here"

# run FOLDER FRAMES NAME OPTIONS: what the tool knows of frames.
run() {
  folder=$1 numbers=$2 name=$3
  shift 3
  "$ssdo" "$folder/frames/frame_#####.exr" --frames "$numbers" -o "$folder/tool/${name}_#####.exr" \
    --compression none --on-error continue --skip-existing -q --env-up z --prior rules "$@" || true
}

# The same without a radius, beyond the border extended and open.
run_far() {
  run "$1" "$2" far --radius inf --products ao,guessed,bent,direct --env "$work/linear.exr"
  run "$1" "$2" far_open --radius inf --products ao --offscreen open
}

# make.sh batch WORK SSDO FRAMES FIRST: 100 frames, or as many as there are to be.
if [ "$1" = batch ]; then
  work=$2 ssdo=$3 frames=$4 first=$5
  last=$((first + 99))
  [ "$last" -lt "$frames" ] || last=$((frames - 1))
  cache=$(printf '%s/cache/%05d_%05d.npz' "$work" "$first" "$last")
  [ ! -f "$cache" ] || exit 0
  "$work/generate" "$work/frames" "$first" $((last - first + 1))
  run_far "$work" "$first-$last"
  run "$work" "$first-$last" near --radius 1 --products ao,guessed,bent
  run "$work" "$first-$last" near_open --radius 1 --products ao --offscreen open
  # One frame of five, with the camera turned by a degree.
  turned=$((first + 3))
  for i in $(seq $turned 5 "$last"); do "$work/generate" --turn 1 "$work/turned/frames" "$i" 1; done
  run_far "$work/turned" "$turned-${last}x5"
  exec /usr/bin/python3 "$here/dataset.py" "$work" "$first" "$last" "$cache"
fi

work=$1 ssdo=$2 frames=$3 out=${4:-$1}
mkdir -p "$out" "$work/cache" "$work/frames" "$work/tool" "$work/turned/frames" "$work/turned/tool"
if [ ! -x "$work/generate" ]; then
  g++ -std=c++20 -O2 -march=native "$here"/generator/*.cpp -o "$work/generate" \
    -lembree3 -lOpenImageIO -lOpenImageIO_Util
fi
[ -f "$work/linear.exr" ] || /usr/bin/python3 "$here/linear_map.py" "$work/linear.exr"
seq 0 100 $((frames - 1)) | xargs -P "$(nproc)" -n 1 sh "$0" batch "$work" "$ssdo" "$frames"

/usr/bin/python3 "$here/train.py" "$work" "$out"
/usr/bin/python3 "$here/vectors.py" "$out/prior.bin" "$here/../room_corner.exr" "$out/vectors.txt"
