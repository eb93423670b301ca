#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes known.jpg, an interior with more and more known, and prior.jpg, a street and the interior by
# rules and by the network; both beside a path tracer. Usage: known.sh SCENES [SSDO]. SCENES holds the
# folders corner and street with G-buffers, views and path-traced light, and its folder beside, env, has
# maps; these are not in this repository. By default the binary in build/release. Needs oiiotool and
# fontconfig.
set -euo pipefail

pictures=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scenes=$(realpath "$1")
tool=$(realpath "${2:-$pictures/../../build/release/ssdo}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

normal=ViewLayer.Normal albedo=ViewLayer.DiffCol
room=$scenes/corner street=$scenes/street sky=$scenes/../env/venice.exr
views=(--also "$room/also_left.exr" --also "$room/also_right.exr" --also "$room/also_top.exr"
  --also "$room/also_pano.exr")
light() {  # NAME FILE [options]: its ao and light
  "$tool" "$2" --env "$sky" --radius inf --products ao,direct,bounce --pixel-type float --crop \
    -o "$1.exr" --quiet "${@:3}"
  oiiotool "$1.exr" --ch ao.Y,ao.Y,ao.Y --chnames R,G,B -o "$1_ao.exr"
  oiiotool "$1.exr" --ch direct.R,direct.G,direct.B --chnames R,G,B \
    "$1.exr" --ch bounce.R,bounce.G,bounce.B --chnames R,G,B --add -o "$1_light.exr"
}
traced() {  # NAME FOLDER
  # The truth has 0 where there is no normal, and ssdo has 1.
  oiiotool "$2/truth_white.exr" --chnames R,G,B \
    "$2/gbuffer.exr" --ch $normal.X,$normal.Y,$normal.Z --dup --mul --chsum \
    --subc 1 --ch 0,0,0 --chnames R,G,B --sub -o "$1_ao.exr"
  oiiotool "$2/truth_env_direct.exr" --chnames R,G,B "$2/truth_env_bounce1.exr" --chnames R,G,B --add \
    -o "$1_light.exr"
}
light room_rules "$room/gbuffer.exr" --prior rules
light room_alone "$room/gbuffer.exr"
light room_panorama "$room/gbuffer.exr" --also "$room/also_pano.exr"
light room_views "$room/overscan.exr" "${views[@]}"
traced room_traced "$room"
light street_rules "$street/gbuffer.exr" --prior rules
light street_alone "$street/gbuffer.exr"
traced street_traced "$street"

font=$(fc-match --format '%{file}' 'DejaVu Sans')
panel() {  # FILE TEXT
  panels+=("$1" --clamp:max=1 --resize 348x196 --colorconvert linear srgb
    "--text:x=6:y=18:size=14:color=1,0.8,0.2:font=$font" "$2")
}
save() {  # NAME GRID
  oiiotool --nosoftwareattrib "${panels[@]}" --mosaic:pad=4 "$2" -d uint8 --compression jpeg:88 \
    -o "$pictures/$1"
}

columns=(alone panorama views traced)
texts=("the frame alone" "with a panorama" "overscan and four views" "path-traced")
panels=()
for i in "${!columns[@]}"; do panel "room_${columns[i]}_ao.exr" "${texts[i]}"; done
for column in "${columns[@]}"; do
  oiiotool "room_${column}_light.exr" "$room/gbuffer.exr" --ch $albedo.R,$albedo.G,$albedo.B \
    --chnames R,G,B --mul -o "room_${column}_lit.exr"
  panel "room_${column}_lit.exr" ""
done
save known.jpg 4x2

columns=(rules alone traced) texts=("by rules" "by the network" "path-traced")
panels=()
for scene in street room; do
  for i in "${!columns[@]}"; do panel "${scene}_${columns[i]}_ao.exr" "${texts[i]}"; done
done
save prior.jpg 3x2
