#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is needed, builds, and runs every test; a shot on a farm and the package included.
# Once more with a sanitizer, without those two:
#   tests/run.sh address|undefined|thread
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_packages "${build_packages[@]}" "${test_packages[@]}"
sanitizer=${1:-}
[ -n "$sanitizer" ] || install_packages "${farm_packages[@]}"
mkdir -p "$root/build"
folder=$root/build/${sanitizer:-release}
options=(-DSSDO_TESTS=ON -DSSDO_SANITIZE="$sanitizer")
[ -z "${CI:-}" ] || options+=(-DSSDO_WERROR=ON)
build "$folder" all "${options[@]}"
ctest --test-dir "$folder" --output-on-failure --parallel "$(nproc)"
cat "$folder"/reports/*.md
if [ -z "$sanitizer" ]; then
  as_root "$root/tests/farm/run.sh" "$folder/ssdo"
  as_root "$root/tests/package/run.sh" "$folder"
fi
