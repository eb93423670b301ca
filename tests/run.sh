#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is needed, builds, and passes the tests. `all` passes them with sanitizers too,
# fuzzes for ten seconds each, and tries a shot on a farm, the package, faults, the add-on for
# Blender, cppcheck and clang-tidy.
# `edit` is for between two edits: it builds and runs the tests whose files or names hold NAME, with
# what these need, for one instruction set.
#   tests/run.sh [all | edit NAME... | STAGE...]
# A STAGE is release, address, fuzz, thread, farm, package, faults, blender, system (the last four at
# once), lint, tidy, clang (the tests by another compiler), debian13 or testing (on another release) or
# aarch64 (tests of estimators under qemu). $SSDO_OPTIONS goes to cmake, such as -DSSDO_ONE_ISA=avx2.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

mkdir -p "$root/build"
release=$root/build/release
options+=(-DSSDO_TESTS=ON)

build_release() {
  echo "tests/run.sh: building build/release"
  install_packages "${build_packages[@]}" "${test_packages[@]}"
  build "$release" all "${options[@]}"
}

# run_tests FOLDER: as many processes at once as there are cores; failed tests are named.
run_tests() {
  echo "tests/run.sh: running the tests of ${1#"$root"/}"
  ctest --test-dir "$1" --output-on-failure --parallel "$(nproc)" |
    awk -f "$root/tests/name_failures.awk"
}

run_release() {
  build_release
  run_tests "$release"
  cat "$release"/reports/*.md
}

# tests_named NAME...: a line "file Suite.Test" for each test whose file or name holds a NAME.
tests_named() {
  (cd "$root/tests" && grep -roE '^TEST(_F|_P)?\([^,]+, [^)]+' --include='*_test.cpp') |
    sed -E 's@:TEST[^(]*\(([^,]+), @ \1.@' |
    awk 'BEGIN { for (i = 1; i < ARGC; ++i) names[i] = tolower(ARGV[i]); ARGC = 1 }
      { for (i in names) if (index(tolower($0), names[i])) { print; break } }' "$@"
}

# One instruction set, and loops that are optimised less: half of the time to compile them, for the
# same bits.
run_edit() {
  local edit=$root/build/edit isa=scalar found
  found=$(tests_named "$@")
  [ -n "$found" ] || { echo "tests/run.sh: no test is named $*" >&2; return 1; }
  grep -qw avx2 /proc/cpuinfo && isa=avx2
  install_packages "${build_packages[@]}" "${test_packages[@]}"
  build "$edit" test_programs "${options[@]}" \
    -DSSDO_UNITY=OFF -DSSDO_ONE_ISA=$isa -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" \
    -DSSDO_ONLY_TESTS="$(cut -d' ' -f1 <<<"$found" | sort -u | paste -sd';')"
  GTEST_FILTER=$(sed 's/.* \(.*\)/\1:*\/\1\/*/' <<<"$found" | paste -sd:) run_tests "$edit"
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

# tidy FILE...: clang-tidy as .clang-tidy says. Configuring writes the files that sources embed.
tidy() {
  install_packages "${build_packages[@]}" clang clang-tidy
  CXX=clang++ configure "$root/build/tidy" -DSSDO_TESTS=OFF -DSSDO_ONE_ISA=avx2 \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
  printf '%s\n' "$@" | xargs -n 1 -P "$(nproc)" clang-tidy -p "$root/build/tidy" --quiet
}

# build_sanitized NAME TARGET [cmake options]: the tool with a sanitizer, and the tests as they are.
build_sanitized() {
  build_release
  install_packages clang llvm
  CXX=clang++ build "$root/build/$1" "$2" "${options[@]}" -DSSDO_COMPILED_TESTS="$release" "${@:3}"
}
build_address() {
  build_sanitized address "$1" -DSSDO_SANITIZE=address,undefined,float-cast-overflow \
    -DSSDO_ONE_ISA=avx2 -DSSDO_FUZZ=ON
}

# test_sanitized NAME FILTER: runs the tests of FILTER. What sanitizers find, in the tool as a
# process too, is in files; a file is a failure.
test_sanitized() (
  findings=$root/build/$1/findings failed=0
  rm -rf "$findings"
  mkdir -m 1777 "$findings"  # tests run the tool as another user too
  common=log_path=$findings/report:exitcode=86
  export SSDO_RANDOM_FRAMES=20  # of 600
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

run_address() {
  build_address all_tests
  test_sanitized address "-$(names address_left_out.txt)"
}

run_fuzz() {
  build_address fuzz
  "$root/tests/fuzz/run.sh" "$root/build/address"
}

run_thread() {
  build_sanitized thread all_tests -DSSDO_SANITIZE=thread -DSSDO_ONE_ISA=scalar
  test_sanitized thread "$(names threaded.txt)"
}

run_clang() {
  install_packages "${build_packages[@]}" "${test_packages[@]}" clang
  CXX=clang++ build "$root/build/clang" all "${options[@]}"
  run_tests "$root/build/clang"
}

# Not of `all`: these build everything once more.
run_debian13() { on_platform trixie; }
run_testing() { on_platform testing; }
run_aarch64() { on_platform bookworm tests/platforms/aarch64.sh; }

# on_platform RELEASE [COMMAND]: other compilers than this release's warn of more, and wrongly.
on_platform() {
  install_packages debootstrap
  as_root env CI="${CI:-}" SSDO_OPTIONS="-DSSDO_WERROR=OFF ${SSDO_OPTIONS:-}" \
    "$root/tests/platforms/run.sh" "$@"
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

run_blender() {
  install_packages "${blender_packages[@]}"
  "$root/tests/blender/run.sh" "$release/ssdo"
}

# Each of these waits for daemons, disks and signals for much of its time. What they print is shown
# when all have ended, of those that failed last.
run_system() (
  # apt serves one at a time
  install_packages "${farm_packages[@]}" "${fault_packages[@]}" "${blender_packages[@]}"
  logs=$(mktemp -d) failed=()
  trap 'rm -rf "$logs"' EXIT
  for stage in farm package faults blender; do
    (SECONDS=0; "run_$stage"; echo "tests/run.sh: $stage took $SECONDS s") >"$logs/$stage" 2>&1 &
    pids[$!]=$stage
  done
  for pid in "${!pids[@]}"; do
    if wait "$pid"; then cat "$logs/${pids[$pid]}"; else failed+=("${pids[$pid]}"); fi
  done
  for stage in "${failed[@]}"; do
    cat "$logs/$stage"
    echo "tests/run.sh: $stage failed"
  done
  exit ${#failed[@]}
)

case "${1:-}" in
  "") set -- release ;;
  all) set -- release address fuzz thread system lint ;;
  edit) shift; run_edit "$@"; exit ;;
esac
number=0
for stage in "$@"; do
  SECONDS=0
  echo "tests/run.sh: $stage, stage $((++number)) of $#"
  "run_$stage"
  echo "tests/run.sh: $stage took $SECONDS s"
done
