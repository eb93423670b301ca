# SPDX-License-Identifier: Apache-2.0
# smoke.sh PREFIX: tries what is installed in PREFIX, in a folder with still_life.exr, sky.exr, and
# expected.exr and .png that another build has made of them. A plain user's, with a POSIX shell.
set -eu
tool=$1/bin/ssdo share=$1/share

fail() {
  echo "smoke.sh: $*" >&2
  exit 1
}

# expect_status CODE ARGUMENTS...
expect_status() {
  expected=$1 found=0
  shift
  "$tool" "$@" >/dev/null 2>&1 || found=$?
  [ "$found" -eq "$expected" ] || fail "'ssdo $*' ended with $found instead of $expected"
}

[ "$(id -u)" -ne 0 ] || fail "is to be run by a plain user"
"$tool" --version | grep -qx 'ssdo [0-9.]*' || fail "no version"
"$tool" --help | grep -q -e --env || fail "no help"
"$tool" info still_life.exr | grep -q 'fitted from P' || fail "no description of the frame"
"$tool" still_life.exr -o relit.exr -o relit.png --env sky.exr
cmp relit.exr expected.exr
cmp relit.png expected.png
"$tool" still_life.exr -o config.png --env sky.exr --ocio "$share/ssdo/color/config.ocio"
cmp config.png expected.png
expect_status 2 still_life.exr --no-such-option
expect_status 3 missing.exr -o none.exr
expect_status 5 still_life.exr -o relit.exr
expect_status 5 still_life.exr -o /usr/none.exr
[ -s "$share/ssdo/blender/ssdo_relight.py" ] || fail "no add-on for Blender"
for page in man1/ssdo.1 man7/ssdo-farm.7 man7/ssdo-methods.7; do
  gzip -dc "$share/man/$page.gz" | grep -q '^\.TH' || fail "$page is no page"
done
for script in bash-completion/completions/ssdo zsh/site-functions/_ssdo; do
  grep -q -e --env "$share/$script" || fail "$script completes nothing"
done
grep -q 'Chart.js' "$share/doc/ssdo/copyright" || fail "the licence of Chart.js is missing"
gzip -t "$share/doc/ssdo/changelog.gz"
