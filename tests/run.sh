#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is needed, builds, and runs every test. Once more with a sanitizer:
#   tests/run.sh address|undefined|thread
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_packages "${build_packages[@]}" "${test_packages[@]}"
mkdir -p "$root/build"
sanitizer=${1:-}
folder=$root/build/${sanitizer:-release}
options=(-DSSDO_TESTS=ON -DSSDO_SANITIZE="$sanitizer")
[ -z "${CI:-}" ] || options+=(-DSSDO_WERROR=ON)
build "$folder" all "${options[@]}"
ctest --test-dir "$folder" --output-on-failure --parallel "$(nproc)"
cat "$folder"/reports/*.md
