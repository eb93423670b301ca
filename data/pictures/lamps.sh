#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes lamps.jpg: what three lamps give the still life, each in its layers, and a mix of them in other
# colours; below, the same by a path tracer. Usage: lamps.sh [SSDO]; by default the binary in
# build/release. Needs Blender, oiiotool and fontconfig, and takes a few minutes.
set -euo pipefail

pictures=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tool=$(realpath "${1:-$pictures/../../build/release/ssdo}")
frame=$pictures/../still_life.exr
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

lamps=(key rim bulb)
declare -A mix=([key]=0.35,0.5,0.9 [rim]=1.6,0.8,0.5 [bulb]=2,2,2)

albedo=ViewLayer.DiffCol
"$tool" "$frame" --env 0,0,0 --lights "${frame%.exr}.lights.json" --per-light --keep-channels \
  --products direct,bounce -o layers.exr --quiet
for lamp in "${lamps[@]}"; do
  oiiotool layers.exr --ch direct.$lamp.R,direct.$lamp.G,direct.$lamp.B \
    layers.exr --ch bounce.$lamp.R,bounce.$lamp.G,bounce.$lamp.B --add \
    layers.exr --ch $albedo.R,$albedo.G,$albedo.B --mul --chnames R,G,B -o ssdo_$lamp.exr
  blender -b -P "$pictures/../blender/export.py" -- still_life -o traced.exr --samples 256 \
    --world black --lamp $lamp --bounces 1 >blender.log
  oiiotool traced.exr --ch ViewLayer.Combined.R,ViewLayer.Combined.G,ViewLayer.Combined.B \
    --chnames R,G,B -o traced_$lamp.exr
done

font=$(fc-match --format '%{file}' 'DejaVu Sans')
panels=()
for by in ssdo traced; do
  sum=()
  for lamp in "${lamps[@]}"; do
    panels+=("${by}_$lamp.exr" --mulc 1.5 --clamp:max=1 --resize 360x202 --colorconvert linear srgb
      "--text:x=6:y=18:size=14:font=$font" "$lamp${by/ssdo/}")
    sum+=("${by}_$lamp.exr" --mulc "${mix[$lamp]}")
    [ ${#sum[@]} -le 3 ] || sum+=(--add)
  done
  panels+=("${sum[@]}" --mulc 1.5 --clamp:max=1 --resize 360x202 --colorconvert linear srgb
    "--text:x=6:y=18:size=14:font=$font" "mix${by/ssdo/}")
done
for i in "${!panels[@]}"; do panels[i]=${panels[i]/%traced/, path-traced}; done
oiiotool --nosoftwareattrib "${panels[@]}" --mosaic:pad=4 4x2 -d uint8 --compression jpeg:88 \
  -o "$pictures/lamps.jpg"
