#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is needed, builds, and runs every test; a shot on a farm, the package, faults and
# cppcheck included. Or some stages, of which those of sanitizers, address and thread, are run on
# request only:
#   tests/run.sh [release|lint|address|thread|farm|package|faults]...
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

mkdir -p "$root/build"
release=$root/build/release
options=(-DSSDO_TESTS=ON)
[ -z "${CI:-}" ] || options+=(-DSSDO_WERROR=ON)

build_release() {
  install_packages "${build_packages[@]}" "${test_packages[@]}"
  build "$release" all "${options[@]}"
}

run_release() {
  build_release
  ctest --test-dir "$release" --output-on-failure --parallel "$(nproc)"
  cat "$release"/reports/*.md
}

run_lint() {
  install_packages "${build_packages[@]}" cppcheck
  build "$release" ssdo_images "${options[@]}"  # configuring writes the files that sources embed
  cd "$root"
  cppcheck --language=c++ --std=c++20 --quiet -j "$(nproc)" --error-exitcode=1 \
    --enable=warning,performance,portability --inline-suppr \
    --suppressions-list=tests/cppcheck.txt -I src -I "$release" src
}

# sanitize NAME SANITIZERS FILTER: runs the tests of FILTER with the tool compiled for SANITIZERS.
# What those find, in the tool as a process too, is in files; a file is a failure.
sanitize() (
  folder=$root/build/$1 findings=$root/build/$1/findings failed=0 tests=()
  build_release
  install_packages clang
  CXX=clang++ build "$folder" ssdo_tests "${options[@]}" -DSSDO_SANITIZE="$2" -DSSDO_ONE_ISA=avx2 \
    -DSSDO_COMPILED_TESTS="$release"
  rm -rf "$findings"
  mkdir -m 1777 "$findings"  # tests run the tool as another user too
  shards=$(nproc)
  common=log_path=$findings/report:exitcode=86
  export GTEST_TOTAL_SHARDS=$shards UBSAN_OPTIONS=$common:print_stacktrace=1
  export ASAN_OPTIONS=$common:allocator_may_return_null=1:handle_abort=1
  export TSAN_OPTIONS=$common:ignore_noninstrumented_modules=1
  for ((shard = 0; shard < shards; ++shard)); do
    GTEST_SHARD_INDEX=$shard "$folder/tests/ssdo_tests" --gtest_brief=1 --gtest_filter="$3" &
    tests+=($!)
  done
  for test in "${tests[@]}"; do wait "$test" || failed=1; done
  for report in "$findings"/*; do
    [ -e "$report" ] || continue
    cat "$report"
    failed=1
  done
  exit $failed
)

# A list of tests as a filter of GoogleTest.
names() { grep -v '^#' "$root/tests/$1" | paste -sd:; }

run_address() { sanitize address address,undefined,float-cast-overflow "-$(names address_left_out.txt)"; }

run_thread() { sanitize thread thread "$(names threaded.txt)"; }

run_farm() {
  install_packages "${farm_packages[@]}"
  as_root "$root/tests/farm/run.sh" "$release/ssdo"
}

run_package() {
  install_packages "${farm_packages[@]}"
  as_root "$root/tests/package/run.sh" "$release"
}

run_faults() {
  install_packages "${fault_packages[@]}"
  as_root "$root/tests/faults/run.sh" "$release/ssdo" 24
}

[ $# -gt 0 ] || set -- release farm package faults lint
for stage in "$@"; do
  SECONDS=0
  "run_$stage"
  echo "tests/run.sh: $stage took $SECONDS s"
done
