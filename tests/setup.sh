# SPDX-License-Identifier: Apache-2.0
# Sourced by tests/run.sh and data/demo.sh: installs what a Debian machine lacks, and builds.

set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi; }

# Installs those of the named packages that are missing; asks nothing, and is quick when none is.
install_packages() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  echo "Installing ${missing[*]}"
  as_root apt-get update -qq
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

build_packages=(g++ cmake ninja-build pkg-config libopenexr-dev libopenimageio-dev openimageio-tools
  libopencolorio-dev libeigen3-dev libglm-dev libtbb-dev libembree-dev libhwy-dev libdeflate-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libtomlplusplus-dev)
test_packages=(libgtest-dev libgmock-dev groff chromium zsh)
farm_packages=(slurm-wlm munge parallel make debootstrap dpkg-dev file patchelf)  # of tests/farm and tests/package
fault_packages=(strace libopenblas0)  # of tests/faults; OpenBLAS starts threads where OpenCV loads it
blender_packages=(blender)  # of tests/blender

# A list of tests as a filter of GoogleTest.
names() { grep -v '^#' "$root/tests/$1" | paste -sd:; }

# For cmake: in CI warnings are errors, unless $SSDO_OPTIONS says otherwise.
read -ra options <<<"${CI:+-DSSDO_WERROR=ON} ${SSDO_OPTIONS:-}"

configure() {  # FOLDER [cmake options]
  cmake -S "$root" -B "$1" -G Ninja "${@:2}" >"$1.log" 2>&1 || { cat "$1.log"; return 1; }
}

# build FOLDER TARGET [cmake options]: configures FOLDER and builds TARGET in it.
build() {
  configure "$1" -DSSDO_UNITY=ON "${@:3}"
  cmake --build "$1" --target "$2"
}
