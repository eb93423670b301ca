#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds for aarch64 with a cross compiler, and runs under qemu the unit tests up to one frame's light
# and the recorded hashes, which are those of x86-64. qemu takes longer than a sanitizer,
# and leaves out the same tests. It has a Debian of its own, in which libraries are arm64's:
# tests/platforms/run.sh bookworm tests/platforms/aarch64.sh
source "$(dirname "${BASH_SOURCE[0]}")/../setup.sh"

tested=(base io scene estimators filters prior color metrics relight hash)

# Headers alone are of no architecture.
packages=(g++-aarch64-linux-gnu qemu-user-static)
for package in "${build_packages[@]}" libgtest-dev libgmock-dev; do
  case $package in
    g++) ;;
    libeigen3-dev | libglm-dev | libcli11-dev) packages+=("$package") ;;
    lib* | openimageio-tools) packages+=("$package:arm64") ;;
    *) packages+=("$package") ;;
  esac
done
dpkg --add-architecture arm64
install_packages "${packages[@]}"

export PKG_CONFIG_LIBDIR=/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig
folder=$root/build/aarch64
build "$folder" ssdo_images -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
  -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ -DCMAKE_CROSSCOMPILING_EMULATOR=qemu-aarch64-static \
  -DSSDO_TESTS=ON "${options[@]}"
cmake --build "$folder" --target "${tested[@]/%/_tests}" ssdo
export GTEST_FILTER="-$(names address_left_out.txt)"
ctest --test-dir "$folder" --output-on-failure --parallel "$(nproc)" \
  --tests-regex "^($(IFS='|'; echo "${tested[*]}"))_[0-9]+$" | awk -f "$root/tests/name_failures.awk"
