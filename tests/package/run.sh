#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian package, installs it on a bare Debian of this machine's release, tries it there as a
# plain user and purges it; then the same trial of `cmake --install`, in a folder that was moved, and of
# the bundle, on bare systems of that release and the next, or of one where CI is set. Those are kept in
# $SSDO_ROOTS.
# Usage: run.sh [BUILD]; by default build/release, which holds a finished build. As root.
set -euo pipefail

folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$folder/../platforms/roots.sh"
roots=${SSDO_ROOTS:-/var/tmp/ssdo_roots}
data=$folder/../../data
own=$(. /etc/os-release && echo "$VERSION_CODENAME")
# The bundle takes the C library of its build or a later one. Another release is one more debootstrap,
# which CI has no time for.
releases=("$own")
[ -n "${CI:-}" ] || [ "$own" = trixie ] || releases+=(trixie)
build=$(realpath -m "${1:-$folder/../../build/release}")

say() { echo "[${SECONDS}s] $*"; }

fail() {
  echo "tests/package: $*" >&2
  exit 1
}

check_machine() {
  local program
  [ "$(id -u)" -eq 0 ] || fail "a bare Debian is made by root; run this as root"
  for program in debootstrap dpkg-shlibdeps cpack file setpriv patchelf; do
    command -v "$program" >/dev/null || fail "$program is missing; install debootstrap, dpkg-dev, file and patchelf"
  done
  [ -x "$build/ssdo" ] || fail "$build holds no binary; build it or name another folder"
  unshare --mount true || fail "this container may not mount /proc for the bare Debian; allow SYS_ADMIN"
}

make_package() {
  (cd "$build" && cpack -G DEB -B "$work/package") >"$work/cpack.log" 2>&1 ||
    { cat "$work/cpack.log"; fail "cpack failed"; }
  package=$(echo "$work"/package/*.deb)
  say "$(basename "$package"), $(stat --format=%s "$package") bytes"
  dpkg --info "$package" | sed -n 's/^ \(Depends\)/\1/p'
  dpkg --contents "$package"
}

# bare_root RELEASE: a bare Debian, which is kept for the next run and stays bare.
bare_root() {
  [ -d "$roots/bare-$1" ] || make_root "$1" "$roots/bare-$1"
  echo "$roots/bare-$1"
}

# What the tool of the build folder makes of a frame.
make_expected() {
  mkdir "$work/expected"
  cp "$data/still_life.exr" "$data/environments/sky.exr" "$folder/smoke.sh" "$work/expected"
  (cd "$work/expected" && "$build/ssdo" still_life.exr -o expected.exr -o expected.png --env sky.exr)
}

# trial_folder FOLDER: with the frame and what is expected of it, a plain user's own.
trial_folder() {
  cp -r "$work/expected" "$1"
  chown -R nobody "$1"
}

test_package() {
  local bare
  bare=$(bare_root "$own")
  cp -a "$bare" "$work/root"
  trial_folder "$work/root/trial"
  cp "$package" "$work/root/ssdo.deb"
  in_root "$work/root" root "apt-get update -qq && apt-get install -qq --no-install-recommends \
    -o Dpkg::Options::=--force-unsafe-io /ssdo.deb" >"$work/apt.log" 2>&1 ||
    { tail -20 "$work/apt.log"; fail "the package does not install"; }
  say "package installed, with what it depends on: $(du -sh "$work/root" | cut -f1)"
  in_root "$work/root" nobody "cd /trial && sh smoke.sh /usr"
  in_root "$work/root" root "apt-get purge -qq ssdo" >"$work/apt.log" 2>&1 || fail "the package cannot be purged"
  rm -r "$work"/root/{ssdo.deb,trial}
  local left
  left=$(find "$work/root" -xdev -name '*ssdo*' -not -path '*/lib/apt/lists/*' -not -path "$work/root/tmp/*")
  [ -z "$left" ] || fail "purged, and left behind: $left"
  say "package: tried by a plain user and purged; nothing is left"
}

test_install() {
  cmake --install "$build" --prefix "$work/first" >"$work/install.log"
  mv "$work/first" "$work/moved"
  trial_folder "$work/trial"
  (cd "$work/trial" && setpriv --reuid=nobody --regid=nogroup --clear-groups sh smoke.sh "$work/moved")
  say "cmake --install: tried by a plain user, after its folder was moved"
}

# The trial folder is the only thing that a bare system gets: its own libraries are those of apt.
test_bundle() {
  local release bare
  (cd "$build" && cpack -G TGZ -B "$work/bundle") >"$work/cpack.log" 2>&1 ||
    { cat "$work/cpack.log"; fail "cpack -G TGZ failed"; }
  say "$(basename "$work"/bundle/*.tar.gz), $(stat --format=%s "$work"/bundle/*.tar.gz) bytes"
  mkdir "$work/trials"
  for release in "${releases[@]}"; do
    bare=$(bare_root "$release")
    trial_folder "$work/trials/$release"
    tar -xzf "$work"/bundle/*.tar.gz -C "$work/trials/$release"
    mv "$work/trials/$release"/ssdo-* "$work/trials/$release/any where"
    binds=("$work/trials/$release /mnt")
    in_root "$bare" nobody "cd /mnt && sh smoke.sh '/mnt/any where'"
    say "bundle of $(du -sh "$work/trials/$release/any where" | cut -f1): tried on a bare $release"
  done
}

check_machine
work=$(mktemp -d)
chmod 755 "$work"
trap 'rm -rf "$work"' EXIT
trap 'exit 143' INT TERM
make_expected
make_package
test_install
test_package
test_bundle
say "all passed"
