#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes bench.png: speed against error of every method and setting on the still life, as the page of
# `ssdo bench` shows them. Usage: bench.sh [SSDO]; by default the binary in build/release. Needs
# chromium. The machine should have nothing else to do.
set -euo pipefail

pictures=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tool=$(realpath "${1:-$pictures/../../build/release/ssdo}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$tool" bench "$pictures/../still_life.exr" --products ao --radius 2 \
  --truth "$pictures/../truth/still_life/ao_2.exr:AO" --report report.html

# The chart alone.
hidden='header, nav, section:not(.chart) { display: none } main { display: block; padding: 0 }'
sed "0,/<\/style>/s//$hidden<\/style>/" report.html >chart.html
chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=953,582 \
  --virtual-time-budget=5000 --screenshot="$pictures/bench.png" "file://$work/chart.html"
