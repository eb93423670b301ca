#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is needed, builds the tool, and relights the still life under the sky.
source "$(dirname "${BASH_SOURCE[0]}")/../tests/setup.sh"

install_packages "${build_packages[@]}"
mkdir -p "$root/build"
# A fresh machine has no GoogleTest; a folder with the tests keeps them.
[ -e "$root/build/release/CMakeCache.txt" ] || options+=(-DSSDO_TESTS=OFF)
build "$root/build/release" ssdo "${options[@]}"

out=$root/build/demo
"$root/build/release/ssdo" "$root/data/still_life.exr" --env "$root/data/environments/sky.exr" \
  -o "$out/still_life.exr" -o "$out/still_life.png" \
  --save ao="$out/still_life_ao.png" --save bounce="$out/still_life_bounce.png" \
  --create-dirs --overwrite --stats "$out/still_life.json" -v

echo
echo "The relit frame, its products:  $out/still_life.exr"
echo "The composite for a display:    $out/still_life.png"
echo "Occlusion and bounce:           $out/still_life_ao.png, $out/still_life_bounce.png"
sed -n 's/^ *"\(read\|prepare\|estimate\|filter\|compose\|write\|total\)": \([0-9][0-9]*\).*/\1 \2/p' "$out/still_life.json" |
  awk 'BEGIN { printf "It took" } { printf " %s %d ms,", $1, $2 } END { print " by the clock." }'
