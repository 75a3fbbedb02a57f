# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Words of the capture checks, for both sides of the network. Wants: URI, and control() which
# runs a shell command line where the test device is.

frames() {
  perl "$HERE/frames.pl" "$@"
}

# use_table FILE [FORMAT [SCALE]]: what device 0 replays, and how; SCALE in millivolts a code.
use_table() {
  local format=${2:-le:u12/16} scale=${3:-1.25}
  # As text: the way to the device may carry lines only.
  control "use_table_text $(od -An -v -tx1 "$1" | tr -d ' \n') '$format' $scale"
}

use_table_text() {
  local channel folder
  echo "$1" | perl -ne 'chomp; print pack "H*", $_' >"$REPLAY.0/table"
  write "$2" "$REPLAY.0/format"
  # A server tells the formats of its start.
  if [[ -n ${IIOD:-} && $2 != "${FORMAT_SERVED:-}" ]]; then
    FORMAT_SERVED=$2
    restart_iiod
  fi
  write 1 "$REPLAY.0/untriggered"
  folder=$(iio_folder shaft)
  for channel in 0 1 2 3; do
    write "$3" "$folder/in_voltage${channel}_scale"
  done
}

# start_capture FILE COMMAND...: in the background, until the device runs; sets CAPTURE.
start_capture() {
  local file=$1
  shift
  "$@" >"$file" 2>"$file.err" &
  CAPTURE=$!
  control "wait_for 20 running" || { cat "$file.err"; return 1; }
}

# push "COUNT PERIOD_NS [wait]"
push() {
  control "write '$1' $REPLAY.0/push"
}

# capture_rows FILE: rows of a capture in text form, without its header.
capture_rows() {
  grep -v '^#' "$1" | tail -n +2
}

# column FILE NAME: one column of a CSV file.
column() {
  grep -v '^#' "$1" | awk -F, -v name="$2" '
    NR == 1 {for (i = 1; i <= NF; i++) if ($i == name) at = i; if (!at) exit 1; next}
    {print $at}'
}
