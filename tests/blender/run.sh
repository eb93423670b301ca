#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The add-on data/blender/ssdo_relight.py in Blender, without a window: installed as an artist does.
# Usage: run.sh [SSDO]; by default the binary in build/release. Needs blender and oiiotool.
set -euo pipefail

folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tool=$(realpath -m "${1:-$folder/../../build/release/ssdo}")
for program in blender oiiotool "$tool"; do
  command -v "$program" >/dev/null || { echo "tests/blender: $program is missing" >&2; exit 1; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 143' INT TERM
export BLENDER_USER_CONFIG=$work/config BLENDER_USER_SCRIPTS=$work/scripts
mkdir "$work"/{config,scripts,temporary}
blender -b --factory-startup -noaudio --python-exit-code 1 -P "$folder/addon.py" -- \
  "$tool" "$work" >"$work/log" 2>&1 || { cat "$work/log"; echo "tests/blender: failed" >&2; exit 1; }
grep '^Ran ' "$work/log"
