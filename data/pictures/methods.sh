#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes methods.jpg: the still life's ao by a path tracer and by every method, at radius 2 where they
# have one. Usage: methods.sh [SSDO]; by default the binary in build/release. Needs oiiotool and
# fontconfig.
set -euo pipefail

pictures=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tool=$(realpath "${1:-$pictures/../../build/release/ssdo}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The truth has 0 where there is no normal, and ssdo has 1.
normal=ViewLayer.Normal
oiiotool "$pictures/../truth/still_life/ao_2.exr" --ch ViewLayer.AO.G \
  "$pictures/../still_life.exr" --ch $normal.X,$normal.Y,$normal.Z --dup --mul --chsum \
  --subc 1 --sub -d uint8 -o path-traced.png
names=(path-traced)
for method in $("$tool" --list-methods | sed -n 's/^\([a-z-]*\)  .*/\1/p'); do
  radius=(--radius 2)
  [ "$method" != msvo ] || radius=()
  "$tool" "$pictures/../still_life.exr" --method "$method" "${radius[@]}" --save ao="$method.png" --quiet
  names+=("$method")
done

font=$(fc-match --format '%{file}' 'DejaVu Sans')
panels=()
for name in "${names[@]}"; do
  panels+=("$name.png" --ch 0,0,0 --resize 288x162
    "--text:x=6:y=18:size=15:color=0,0,0:font=$font" "$name")
done
oiiotool --nosoftwareattrib "${panels[@]}" --create 288x162 3 --addc 1 --mosaic:pad=4 4x3 -d uint8 --compression jpeg:88 \
  -o "$pictures/methods.jpg"
