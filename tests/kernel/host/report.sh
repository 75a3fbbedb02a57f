# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Numbers and counts the results of all guests and of this side.

TALLY=$WORK/tally
: >"$TALLY"

# "ok - TEXT" and "not ok - TEXT" get their number; anything else is printed as it is.
number_line() {
  local number
  case $1 in
    'ok - '* | 'not ok - '*)
      echo "${1%% - *}" >>"$TALLY"
      number=$(wc -l <"$TALLY")
      echo "${1%% - *} $number - ${1#* - }"
      ;;
    *) echo "$1" ;;
  esac
}

# Closes the run; fails when a check failed or none ran.
summary() {
  local passed failed
  passed=$(grep -c '^ok$' "$TALLY" || true)
  failed=$(grep -c '^not ok$' "$TALLY" || true)
  echo "$passed passed, $failed failed"
  ((failed == 0 && passed > 0))
}
