# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The same by the sanitized binaries: any finding is a failed check.

# asan CHECK...: with their programs first in the path.
asan() {
  export PATH=/run/ada4571/asan:$PATH LD_LIBRARY_PATH=/run/ada4571/asan
  export ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1
  [[ -x /run/ada4571/asan/iio-angle ]] || fail "no iio-angle in $ASAN_BUILD"
  "$@"
}

if [[ -n $ASAN_BUILD ]]; then
  load_replay devices=1 labels=shaft
  check "sanitized: decoding" asan capture_format "le:u24/32 le:u16/16 be:s12/16>>4 be:u24/32>>8"
  check "sanitized: record, calibrate, convert and read" asan capture_job
  check "sanitized: SigMF" asan capture_sigmf
  check "sanitized: time-out" asan capture_timeout
  check "sanitized: cancel" asan capture_cancel
  check "sanitized: unplug and replug" asan capture_replug
  check "sanitized: calibbias and calibscale" asan capture_calibbias
else
  report "# no sanitized build was given: its checks are left out"
fi
