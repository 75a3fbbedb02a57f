# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# What a check is, in the guest and on this side alike. A check is a shell function that fails by
# a command that fails; its output is shown only then. Wants: report(), SCRATCH, ONLY.

# check TEXT FUNCTION [ARGUMENT...]
check() {
  [[ -z ${ONLY:-} || $2 == *$ONLY* ]] || return 0
  local folder=$SCRATCH/check log=$SCRATCH/check.log status
  rm -rf "$folder"
  mkdir -p "$folder"
  (
    set -euo pipefail
    trap 'kill -9 $(jobs -p) 2>/dev/null || true' EXIT
    cd "$folder"
    "${@:2}"
  ) >"$log" 2>&1 </dev/null 9>&-
  status=$?
  if ((status == 0)); then
    report "ok - $1"
  else
    report "not ok - $1"
    [[ -s $log ]] || echo "no output" >"$log"
    echo "status $status of: ${*:2}" >>"$log"
    tail -n "${LOG_LINES:-15}" "$log" | cut -c1-300 | while IFS= read -r line; do
      report "#   $line"
    done
  fi
}

fail() {
  echo "$*"
  return 1
}

# same WHAT ACTUAL EXPECTED
same() {
  [[ $2 == "$3" ]] || fail "$1: is '$2', should be '$3'"
}

# between WHAT ACTUAL LOW HIGH, numbers with or without a point
between() {
  awk -v v="$2" -v a="$3" -v b="$4" 'BEGIN {exit !(v + 0 == v && v >= a && v <= b)}' ||
    fail "$1: is '$2', should be in $3 .. $4"
}

# expect STATUS COMMAND...: the command ends with that status.
expect() {
  local status=0
  "${@:2}" || status=$?
  same "exit status of ${*:2}" "$status" "$1"
}

# contains FILE TEXT: the text stands there, as it is.
contains() {
  grep -qF -- "$2" "$1" || { fail "no '$2' in $1:" || head -n 5 "$1"; return 1; }
}

# One sentence for a person: exactly one line, libiio's own notice aside.
one_line() {
  same "lines of $1" "$(grep -cv 'WARNING: High-speed mode not enabled' "$1")" 1
}

# A pause that starts no process.
exec {PAUSE_FD}<> <(:)
pause() {
  read -rt "$1" -u "$PAUSE_FD" || true
}

# wait_for SECONDS COMMAND...: until the command succeeds.
wait_for() {
  local ticks=$(($1 * 100))
  until "${@:2}"; do
    ((ticks-- > 0)) || fail "waited $1 s for: ${*:2}" || return 1
    pause 0.02
  done
}

# ended PID SECONDS: waits for a background process; its status.
ended() {
  local ticks=$(($2 * 100))
  while kill -0 "$1" 2>/dev/null; do
    ((ticks-- > 0)) || { kill -9 "$1"; fail "process $1 has not ended in $2 s"; return 1; }
    pause 0.02
  done
  wait "$1"
}
