#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# completion.sh BUILD COMPLETION: what bash offers after the words typed so far.
set -u
BUILD=$(cd "$1" && pwd)
COMPLETION=$(realpath "$2")
PATH=$BUILD/tools:$PATH
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"
# shellcheck source=/dev/null
. "$COMPLETION"

# offered WORD...: completes the last word.
offered() {
  COMP_WORDS=(iio-angle "$@")
  COMP_CWORD=$#
  COMPREPLY=()
  _iio_angle
  printf '%s\n' "${COMPREPLY[@]}" >out
}

check_verbs_and_options_come_from_the_program() {
  offered cal
  same verb "$(cat out)" calibrate
  offered calibrate s
  same method "$(cat out)" single
  offered record --dur
  same option "$(cat out)" --duration
  offered calibrate single --m
  same option "$(cat out)" --method
  touch capture.csv
  offered check cap
  same file "$(cat out)" capture.csv
}

check_every_verb_of_the_program_is_known() {
  local verb
  for verb in $(iio-angle --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
    offered "$verb" --hel
    same "$verb" "$(grep -x -e --help out)" --help
  done
}

run_checks "${3:-}"
