#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# For classes of faults that are drawn at random by a test program: the same again and again, each
# time from a fresh seed.

# What never ends is ended: by its processor time, which a busy machine does not lengthen, and what
# sleeps for ever by the hour.
PROCESSOR_S=600 HOUR_S=3600

# repeat PROGRAM FILTER FORM TIMES: a try is a test that ran; a program that dies is a failure too.
repeat() {
  local program=$1 filter=$2 times=$4 tries=0 failures=0 i ran failed
  [[ $3 == full ]] || times=1
  for ((i = 0; i < times; i++)); do
    if (ulimit -t "$PROCESSOR_S" &&
      exec timeout "$HOUR_S" "$program" --gtest_filter="$filter") >said 2>&1; then
      failed=0
    else
      failed=$(grep -cE '^\[  FAILED  \] .*ms\)$' said)
      ((failed > 0)) || failed=1
      grep -E 'Failure|ADA4571_TEST_SEED' said | tail -5
    fi
    ran=$(grep -cE '^\[       OK \]|^\[  FAILED  \] .*ms\)$' said)
    tries=$((tries + (ran > failed ? ran : failed)))
    failures=$((failures + failed))
  done
  echo "tries $tries failures $failures"
}
