#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes sources.jpg by the commands of SYSTEMS OF THE SOURCES in man/ssdo-methods.7: the composite of
# each, and its ao on the right.
# Usage: sources.sh [SSDO]; by default the binary in build/release. Needs oiiotool and fontconfig.
set -euo pipefail

pictures=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tool=$(realpath "${1:-$pictures/../../build/release/ssdo}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
ln -s "$pictures/.." data
ssdo() { "$tool" "$@" --save ao="ao_$3" --quiet; }  # $3 is the picture of -o

sed -n '/^\.SH SYSTEMS/,/^\.SH SEE/ { /^\.EX/,/^\.EE/ { s/\\-/-/g; s/\\e$/\\/; /^\.E/!p } }' \
  data/../man/ssdo-methods.7 >commands
source ./commands

font=$(fc-match --format '%{file}' 'DejaVu Sans')
panels=()
for picture in $(grep -o '[^ ]*\.png' commands); do
  panels+=("ao_$picture" --ch 0,0,0 --resize 384x216 --cut 144x216+240+0
    "$picture" --ch 0,1,2 --resize 384x216 --paste +240+0
    "--text:x=8:y=22:size=17:font=$font" "${picture%.png}")
done
oiiotool --nosoftwareattrib "${panels[@]}" --mosaic:pad=4 3x3 -d uint8 --compression jpeg:88 -o "$pictures/sources.jpg"
