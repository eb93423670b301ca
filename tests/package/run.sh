#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian package, installs it on a bare Debian of this machine's release, tries it there as a
# plain user and purges it; then the same trial of `cmake --install`, in a folder that was moved.
# Usage: run.sh [BUILD]; by default build/release, which holds a finished build. As root.
set -euo pipefail

folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export PATH=$PATH:/usr/sbin:/sbin
data=$folder/../../data
build=$(realpath -m "${1:-$folder/../../build/release}")

say() { echo "[${SECONDS}s] $*"; }

fail() {
  echo "tests/package: $*" >&2
  exit 1
}

check_machine() {
  local program
  [ "$(id -u)" -eq 0 ] || fail "a bare Debian is made by root; run this as root"
  for program in debootstrap dpkg-shlibdeps cpack setpriv; do
    command -v "$program" >/dev/null || fail "$program is missing; install debootstrap and dpkg-dev"
  done
  [ -x "$build/ssdo" ] || fail "$build holds no binary; build it or name another folder"
  unshare --mount true || fail "this container may not mount /proc for the bare Debian; allow SYS_ADMIN"
}

# The mirror that this machine's apt takes its own release from.
mirror_of() {
  apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' |
    sed -n "s/^$1 //p" | sed -n 1p
}

make_package() {
  (cd "$build" && cpack -G DEB -B "$work/package") >"$work/cpack.log" 2>&1 ||
    { cat "$work/cpack.log"; fail "cpack failed"; }
  package=$(echo "$work"/package/*.deb)
  say "$(basename "$package"), $(stat --format=%s "$package") bytes"
  dpkg --info "$package" | sed -n 's/^ \(Depends\)/\1/p'
  dpkg --contents "$package"
}

make_root() {
  local release mirror
  release=$(. /etc/os-release && echo "$VERSION_CODENAME")
  mirror=$(mirror_of "$release")
  [ -n "$mirror" ] || fail "apt knows no mirror of $release; run apt-get update"
  debootstrap --variant=minbase "$release" "$work/root" "$mirror" >"$work/debootstrap.log" ||
    { tail -5 "$work/debootstrap.log"; fail "debootstrap failed"; }
  say "a bare Debian, $(du -sh "$work/root" | cut -f1)"
}

# in_root USER COMMAND...: with /proc, which goes away with the command.
in_root() {
  unshare --mount sh -c 'mount -t proc proc "$0/proc" && exec chroot --userspec="$1" "$0" env -i \
    PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 sh -c "$2"' \
    "$work/root" "$@"
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
  trial_folder "$work/root/trial"
  cp "$package" "$work/root/ssdo.deb"
  in_root root "apt-get update -qq && apt-get install -qq --no-install-recommends \
    -o Dpkg::Options::=--force-unsafe-io /ssdo.deb" >"$work/apt.log" 2>&1 ||
    { tail -20 "$work/apt.log"; fail "the package does not install"; }
  say "package installed, with what it depends on: $(du -sh "$work/root" | cut -f1)"
  in_root nobody "cd /trial && sh smoke.sh /usr"
  in_root root "apt-get purge -qq ssdo" >"$work/apt.log" 2>&1 || fail "the package cannot be purged"
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

check_machine
work=$(mktemp -d)
chmod 755 "$work"
trap 'rm -rf "$work"' EXIT
trap 'exit 143' INT TERM
make_expected
make_package
test_install
make_root
test_package
say "all passed"
