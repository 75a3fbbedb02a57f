# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The words that the checks of iio-angle are written in. A check is a function whose name says the
# behaviour; `run_checks` calls every one of them in a folder of its own.

# status WANTED COMMAND...: runs it with standard output in `out` and standard error in `err`.
status() {
  local wanted=$1 got=0
  shift
  "$@" >out 2>err </dev/null || got=$?
  [[ $got == "$wanted" ]] || fail "'$*' ended with $got, not $wanted: $(head -c 500 err)"
}

fail() {
  printf '    %s\n' "$*"
  FAILED=1
}

# says FILE PATTERN: some line of the file matches the extended regular expression.
says() {
  grep -qE -- "$2" "$1" || fail "'$1' does not say '$2' but: $(head -c 500 "$1")"
}

empty() {
  [[ ! -s $1 ]] || fail "'$1' should be empty but says: $(head -c 500 "$1")"
}

absent() {
  local file
  for file; do
    [[ ! -e $file ]] || fail "'$file' should not be there"
  done
}

lines() {
  wc -l <"$1"
}

same() {
  [[ $2 == "$3" ]] || fail "$1: '$2', not '$3'"
}

# column FILE NAME: a column of a CSV file.
column() {
  awk -F, -v name="$2" '/^#/ { next }
    !found { for (i = 1; i <= NF; i++) if ($i == name) found = i; next }
    { print $found }' "$1"
}

# Starts the simulated sensor as a network device: its URI is in $URI, its process in $EMULATOR.
emulate() {
  iio-angle emulate --seed 4571 "$@" >uri 2>emulator.log </dev/null &
  EMULATOR=$!
  local i
  for ((i = 0; i < 200; i++)); do
    [[ ! -s uri ]] || break
    sleep 0.05
  done
  URI=$(head -1 uri)
  [[ $URI == ip:127.0.0.1:* ]] || fail "emulate does not say its URI: $(cat uri emulator.log)"
}

stop_emulator() {
  [[ -n ${EMULATOR:-} ]] || return 0
  kill "$EMULATOR" 2>/dev/null || true
  wait "$EMULATOR" 2>/dev/null || true
  EMULATOR=
}

# until_there COMMAND...: waits until it succeeds; a minute is for what never comes.
until_there() {
  local i
  for ((i = 0; i < 1200; i++)); do
    "$@" && return 0
    sleep 0.05
  done
  fail "still not: $*: $(head -c 500 err)"
}

# written PID: it has written results: to out, or to a file that has no name yet.
written() {
  [[ -s out ]] || [[ -n $(find . -name '*.tmp' -size +0) ]] ||
    find "/proc/$1/fd" -lname '*(deleted)' -exec stat -Lc %s {} + 2>/dev/null | grep -q '^[1-9]'
}

# run_checks [PATTERN]: prints a line a check; fails when one fails, or when there was none.
run_checks() {
  local check work passed=0 failed=0
  for check in $(declare -F | awk '{ print $3 }' | grep '^check_' | grep -E -- "${1:-.}"); do
    work=$(mktemp -d)
    FAILED=
    if (
      cd "$work" || exit 1
      trap stop_emulator EXIT
      "$check"
      [[ -z $FAILED ]]
    ); then
      passed=$((passed + 1)) && printf 'ok      %s\n' "${check#check_}"
    else
      failed=$((failed + 1)) && printf 'FAILED  %s\n' "${check#check_}"
    fi
    rm -rf "$work"
  done
  echo "$passed passed, $failed failed"
  ((failed == 0 && passed > 0))
}
