# SPDX-License-Identifier: Apache-2.0
#
# Reads what `ctest --output-on-failure` prints of processes that each run many tests. Passes on the
# line of each process, and of a failed process only the tests that failed, with what they printed.
# Names them again at the end. A test that has begun and not ended is one that ended its process.

function ends(how) {
  if (how != "") {
    printf "%s", text
    print "FAILED " running how
    failed[++count] = running
  }
  running = text = ""
}

function stopped() { if (running != "") ends(" (its process ended, or took too long)") }

/^ *[0-9]+\/[0-9]+ Test +#/ { stopped(); print; fflush(); next }
/^ +Start +[0-9]+: / { stopped(); next }
/^\[ RUN      \] / { stopped(); running = $4; next }
/^\[       OK \] |^\[  SKIPPED \] / { ends(""); next }
/^\[  FAILED  \] / { if (running != "") ends(" "); next }
/^\[(==========|----------|  PASSED  )\]|^Note: (This is test shard|Google Test filter)/ { next }
/^[0-9]+% tests passed/ { stopped(); print; summary = 1; next }
/^Total Test time/ { print; next }
summary { next }
running != "" { text = text $0 "\n"; next }
/^ *[0-9]+ FAILED TESTS?$|^$|^Running main|^Test project |^Internal ctest / { next }
{ print }

END {
  stopped()
  if (count > 0) print "Failed tests:"
  for (i = 1; i <= count; ++i) print "  " failed[i]
}
