#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What a farm does to a run: full disks, vanishing inputs, signals, too little memory, links, rivals,
# closed pipes. Whatever happens, the run ends, says why in one line, and every output is whole.
# Usage: run.sh [SSDO] [RUNS [GROUP...]]; by default the binary in build/release, 40 runs with a signal
# and all groups: disk inputs outputs signals limits streams calls. As root; the tool itself runs as a
# plain user. SEED=N repeats the random choices of an earlier run.
set -Eeuo pipefail

faults_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$faults_folder/../.." && pwd)
export LC_ALL=C
groups=(disk inputs outputs signals limits streams calls)
source "$faults_folder/checks.sh"
for group in "${groups[@]}"; do source "$faults_folder/$group.sh"; done

check_machine() {
  local program
  [ "$(id -u)" -eq 0 ] || fail "small disks are mounted by root; run this as root"
  for program in setpriv prlimit strace oiiotool; do
    command -v "$program" >/dev/null ||
      fail "$program is missing; install util-linux strace openimageio-tools"
  done
  [ -x "$binary" ] || fail "$binary is missing; build it or name another binary"
}

# A plain user has to reach the tool and its module.
copy_tool() {
  mkdir "$work/bin"
  cp "$binary" "$(dirname "$binary")"/ssdo_images.so "$work/bin"
  tool=$work/bin/ssdo
}

make_inputs() {
  mkdir "$input"
  oiiotool "$root/data/still_life.exr" \
    --dup --cut 192x108+40+60 -o "$input/shot.1001.exr" --pop \
    --dup --cut 192x108+46+62 -o "$input/shot.1002.exr" --pop \
    --dup --cut 192x108+52+64 -o "$input/shot.1003.exr" --pop \
    --dup --cut 96x54+60+70 -o "$frame" --pop \
    --cut 48x32+60+70 -o "$tiny"
  cp "$root/data/environments/sky.exr" "$input"
}

# make_outputs FOLDER OPTIONS...: of runs that nothing disturbs.
make_outputs() {
  mkdir "$1"
  cd "$1"
  "$tool" "${job[@]}" -o a.exr -o a.png -o a.jpg -o a.tif "${@:2}"
  "$tool" "${job[@]}" --save ao=ao.exr "${@:2}"
  "$tool" "${shot[@]}" -o relit.####.exr -o relit.####.png "${@:2}"
}

make_disks() {
  mkdir "$small" "$readonly" "$given"
  mount -t tmpfs -o size=4m,mode=777 tmpfs "$small"
  cp "$old/a.exr" "$readonly"
  mount --bind "$readonly" "$readonly"
  mount -o remount,bind,ro "$readonly"
}

end() {
  cd /
  kill -KILL $(jobs -p) 2>/dev/null || true  # one may be stopped
  umount "$small" "$readonly" 2>/dev/null || true
  drop_group
  rm -rf "$work"
}

binary=$(realpath -m "${1:-$root/build/release/ssdo}")
runs=${2:-40}
check_machine
# Mounts of its own, which end with it.
[ -n "${SSDO_FAULTS_MOUNTS:-}" ] || SSDO_FAULTS_MOUNTS=own exec unshare --mount "$0" "$binary" "$runs" "${@:3}"
[ $# -lt 3 ] || groups=("${@:3}")
seed=${SEED:-$RANDOM}
RANDOM=$seed
umask 0  # what root makes here is for the plain user to replace
ulimit -c 0
work=$(mktemp -d)
chmod 755 "$work"
trap end EXIT
trap 'echo "tests/faults: stopped by line $LINENO: $BASH_COMMAND" >&2' ERR
trap 'exit 143' INT TERM
input=$work/input old=$work/old new=$work/new small=$work/small readonly=$work/readonly
given=$work/given log=$work/log tiny=$input/tiny.exr frame=$input/frame.exr
job=("$frame" -q --env "$input/sky.exr")
shot=("$input/shot.####.exr" -q --env "$input/sky.exr")
copy_tool
make_inputs
make_outputs "$old" --radius 0.5
make_outputs "$new"
"$tool" compare "$old/a.exr" "$new/a.exr" --diff "$old/d.exr" >"$log.out"
make_disks
say "seed $seed"
for group in "${groups[@]}"; do "test_$group"; done
[ "$faults" -eq 0 ] || fail "$faults faults; SEED=$seed repeats them"
say "all passed"
