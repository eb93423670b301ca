#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is needed, builds, and runs every test: also with sanitizers, fuzzing for a minute
# each, a shot on a farm, the package, faults, cppcheck and clang-tidy. Or some stages:
#   tests/run.sh [release|address|fuzz|thread|farm|package|faults|lint|tidy]...
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

mkdir -p "$root/build"
release=$root/build/release
options=(-DSSDO_TESTS=ON)
[ -z "${CI:-}" ] || options+=(-DSSDO_WERROR=ON)

build_release() {
  install_packages "${build_packages[@]}" "${test_packages[@]}"
  build "$release" all "${options[@]}"
}

run_tests() { ctest --test-dir "$1" --output-on-failure --parallel "$(nproc)"; }

run_release() {
  build_release
  run_tests "$release"
  cat "$release"/reports/*.md
}

run_lint() {
  install_packages "${build_packages[@]}" cppcheck
  build "$release" ssdo_images "${options[@]}"  # configuring writes the files that sources embed
  cd "$root"
  cppcheck --language=c++ --std=c++20 --quiet -j "$(nproc)" --error-exitcode=1 \
    --enable=warning,performance,portability --inline-suppr \
    --suppressions-list=tests/cppcheck.txt -I src -I "$release" src
  mapfile -t changed < <(git log --format= --name-only -- 'src/*.cpp' |
    awk 'count < 5 && !seen[$0]++ && system("test -e " $0) == 0 {++count; print}')
  [ ${#changed[@]} -eq 0 ] || tidy "${changed[@]}"
}

# All files take ten minutes; lint takes those that were changed last.
run_tidy() { tidy "$root"/src/{,*/,*/*/,*/*/*/}*.cpp; }

# tidy FILE...: clang-tidy as .clang-tidy says, with the headers and options of the address build.
tidy() {
  build_address ssdo_core
  install_packages clang-tidy
  printf '%s\n' "$@" | xargs -n 1 -P "$(nproc)" clang-tidy -p "$root/build/address" --quiet
}

# build_sanitized NAME TARGET [cmake options]: the tool with a sanitizer, and the tests as they are.
build_sanitized() {
  build_release
  install_packages clang llvm
  CXX=clang++ build "$root/build/$1" "$2" "${options[@]}" -DSSDO_COMPILED_TESTS="$release" "${@:3}"
}
build_address() {
  build_sanitized address "$1" -DSSDO_SANITIZE=address,undefined,float-cast-overflow \
    -DSSDO_ONE_ISA=avx2 -DSSDO_FUZZ=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
}

# test_sanitized NAME FILTER: runs the tests of FILTER. What sanitizers find, in the tool as a
# process too, is in files; a file is a failure.
test_sanitized() (
  findings=$root/build/$1/findings failed=0
  rm -rf "$findings"
  mkdir -m 1777 "$findings"  # tests run the tool as another user too
  common=log_path=$findings/report:exitcode=86
  export SSDO_RANDOM_FRAMES=20  # of 1200
  export UBSAN_OPTIONS=$common:print_stacktrace=1 GTEST_FILTER=$2
  export ASAN_OPTIONS=$common:allocator_may_return_null=1:handle_abort=1
  export LSAN_OPTIONS=suppressions=$root/tests/leaks.txt:print_suppressions=0
  export TSAN_OPTIONS=$common:ignore_noninstrumented_modules=1:suppressions=$root/tests/races.txt
  ulimit -s 65536  # KiB: functions that are watched take more
  run_tests "$root/build/$1" || failed=1
  for report in "$findings"/*; do
    [ -e "$report" ] || continue
    cat "$report"
    failed=1
  done
  exit $failed
)

# A list of tests as a filter of GoogleTest.
names() { grep -v '^#' "$root/tests/$1" | paste -sd:; }

run_address() {
  build_address ssdo_tests
  test_sanitized address "-$(names address_left_out.txt)"
}

run_fuzz() {
  build_address fuzz
  "$root/tests/fuzz/run.sh" "$root/build/address"
}

run_thread() {
  build_sanitized thread ssdo_tests -DSSDO_SANITIZE=thread -DSSDO_ONE_ISA=scalar
  test_sanitized thread "$(names threaded.txt)"
}

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

[ $# -gt 0 ] || set -- release address fuzz thread farm package faults lint
for stage in "$@"; do
  SECONDS=0
  "run_$stage"
  echo "tests/run.sh: $stage took $SECONDS s"
done
