#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs both commands of README in another release of Debian, on this checkout, with a folder build/
# of its own. The release and that folder are in $SSDO_ROOTS and are kept: the second time is quick.
# Usage: run.sh RELEASE [COMMAND...], by default data/demo.sh and tests/run.sh. As root.
set -euo pipefail

fail() {
  echo "tests/platforms: $*" >&2
  exit 1
}

checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$checkout/tests/platforms/roots.sh"
[ $# -gt 0 ] || fail "name a release, such as trixie"
release=$1
shift
[ $# -gt 0 ] || set -- "data/demo.sh && tests/run.sh"
[ "$(id -u)" -eq 0 ] || fail "another Debian is made by root; run this as root"
command -v debootstrap >/dev/null || fail "debootstrap is missing; install it"
unshare --mount true || fail "this container may not mount for another Debian; allow SYS_ADMIN"

roots=${SSDO_ROOTS:-/var/tmp/ssdo_roots}
folder=$roots/$release
mkdir -p "$roots" "$checkout/build"
[ -d "$folder" ] || make_root "$release" "$folder"
mkdir -p "$roots/$release.build"
# Read-only: commands write in build/ alone.
binds=("$checkout $checkout ro" "$roots/$release.build $checkout/build")
variables=(HOME=/root)
for name in CI SSDO_OPTIONS CMAKE_BUILD_PARALLEL_LEVEL CMAKE_CXX_COMPILER_LAUNCHER CCACHE_BASEDIR; do
  [ -z "${!name:-}" ] || variables+=("$name=${!name}")
done
in_root "$folder" root "cd '$checkout' && $*" "${variables[@]}"
