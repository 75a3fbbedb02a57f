#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# safety.sh BUILD [PATTERN]: files, descriptors and signals: nothing is lost, nothing half-written,
# and the exit status is true.
# shellcheck disable=SC2094,SC2119
set -u
BUILD=$(cd "$1" && pwd)
PATH=$BUILD/tools:$PATH
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"

capture() { # capture FILE [OPTIONS]: a second of the simulated sensor
  local file=$1
  shift
  status 0 iio-angle simulate --seed 4571 --duration 1 "$@" -o "$file"
}

# refused FILE COMMAND...: wrong usage, one sentence, and the file is as it was.
refused() {
  local file=$1 before
  shift
  before=$(cksum <"$file")
  status 2 "$@"
  same "sentences of '$*'" "$(lines err)" 1
  same "$file after '$*'" "$(cksum <"$file")" "$before"
}

check_no_verb_writes_over_what_it_reads() {
  capture a.csv
  capture b.csv --temperature constant:deg_c=100
  status 0 iio-angle calibrate single a.csv -o a.toml
  mkdir folder
  ln -s ../a.csv folder/link.csv
  ln a.csv hard.csv
  local name
  for name in a.csv ./a.csv folder/../a.csv "$PWD/a.csv" folder/link.csv hard.csv; do
    refused a.csv iio-angle calibrate single a.csv -o "$name"
    refused a.csv iio-angle convert --calibration a.toml a.csv -o "$name"
    refused a.csv iio-angle diagnose --extend "$name" a.csv
    refused a.csv iio-angle diagnose --report "$name" a.csv
    refused b.csv iio-angle calibrate dual a.csv b.csv -o "$name"
  done
  refused b.csv iio-angle calibrate dual a.csv b.csv -o b.csv
  refused a.toml iio-angle convert --calibration a.toml a.csv -o a.toml
  refused a.toml iio-angle diagnose --model a.toml --extend a.toml a.csv
  refused b.csv iio-angle diagnose --heldout b.csv --report b.csv a.csv
  refused a.toml iio-angle simulate --model a.toml --save-model a.toml -o c.csv
  refused a.csv iio-angle diagnose --extend x --report x a.csv
  absent x c.csv
  # Two outputs in one file, by whatever name: also by links to what is not there yet.
  ln -s x.toml x.html
  ln -s "$PWD/x.toml" absolute.html
  ln -s . here
  local page
  for page in x.html ./x.html here/x.html absolute.html here/here/absolute.html; do
    refused a.csv iio-angle diagnose --extend x.toml --report "$page" a.csv
    says err 'to be written twice'
  done
  absent x.toml
  status 2 iio-angle diagnose --extend - --report - a.csv
  says err 'standard output is to be written twice'
  # By way of standard input, too.
  iio-angle calibrate single - -o a.csv <a.csv 2>err >out
  same "exit status" $? 2
  says a.csv '^time_s'
}

# A redirection that empties the file has done so before the program runs; the others have not.
check_no_redirection_writes_into_what_is_read() {
  capture a.csv
  capture b.sigmf-meta
  status 0 iio-angle calibrate single a.csv -o a.toml
  iio-angle simulate --duration 1 -o - >odd.csv
  local before file
  before=$(cat a.csv b.sigmf-meta b.sigmf-data a.toml odd.csv | cksum)
  ln -s a.csv link.csv
  for file in a.csv link.csv b.sigmf-meta b.sigmf-data; do
    local -a verbs=("check $file" "convert --calibration a.toml $file -o -" "diagnose $file"
      "diagnose --heldout $file odd.csv" "calibrate single $file -o x.toml" "import $file -o -"
      "read --capture $file" "study run $file -o x.study"
      "calibrate dual odd.csv $file -o x.toml")
    local verb
    for verb in "${verbs[@]}"; do
      # shellcheck disable=SC2086
      iio-angle $verb >>$file 2>err
      same "exit status of '$verb' >>$file" $? 2
      says err "^iio-angle: .* is an input, and standard output is redirected into it"
      # shellcheck disable=SC2086
      iio-angle $verb 1<>$file 2>err
      same "exit status of '$verb' 1<>$file" $? 2
      # shellcheck disable=SC2086
      iio-angle $verb >out 2>>$file
      same "exit status of '$verb' 2>>$file" $? 2
      says out "^iio-angle: .* is an input, and standard error is redirected into it"
      # shellcheck disable=SC2086
      iio-angle $verb >>$file 2>&1
      same "exit status of '$verb' >>$file 2>&1" $? 2
    done
  done
  local model
  for model in "convert --calibration a.toml a.csv -o -" "check --calibration a.toml a.csv" \
    "diagnose --model a.toml a.csv" "simulate --model a.toml -o -" \
    "read --calibration a.toml --capture a.csv"; do
    # shellcheck disable=SC2086
    iio-angle $model >>a.toml 2>err
    same "exit status of '$model' >>a.toml" $? 2
  done
  iio-angle check - <a.csv >>a.csv 2>err
  same "exit status" $? 2
  # A mistyped option does not tell what is an input.
  iio-angle check --colour a.csv >out 2>>a.csv
  same "exit status" $? 2
  says out "has no such option"
  absent x.toml x.study
  same "what was read" "$(cat a.csv b.sigmf-meta b.sigmf-data a.toml odd.csv | cksum)" "$before"
  # Two outputs in one file are the user's own.
  status 0 iio-angle check a.csv
  iio-angle check a.csv >>log 2>>log
  same "exit status" $? 0
}

check_nothing_is_diagnosed_twice() {
  capture a.csv
  capture b.sigmf-meta
  ln a.csv hard.csv
  ln -s a.csv link.csv
  local words
  for words in "a.csv a.csv" "a.csv ./a.csv" "a.csv hard.csv" "link.csv a.csv" \
    "a.csv --heldout a.csv" "b.sigmf-meta b.sigmf-data" "- a.csv"; do
    # shellcheck disable=SC2086
    iio-angle diagnose $words <a.csv >out 2>err
    same "exit status of '$words'" $? 2
    says err 'is given twice'
  done
}

check_a_sigmf_recording_is_both_of_its_files() {
  capture a.sigmf-meta
  local name
  for name in a.sigmf-meta a.sigmf-data ./a.sigmf-data; do
    refused a.sigmf-data iio-angle calibrate single a.sigmf-meta -o "$name"
    refused a.sigmf-meta iio-angle calibrate single a.sigmf-data -o "$name"
  done
}

check_the_data_file_that_a_meta_file_names_is_read_too() {
  capture a.sigmf-meta
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  mv a.sigmf-data other.sigmf-data
  sed -i 's/"global": {/&"core:dataset": "other.sigmf-data",/' a.sigmf-meta
  status 0 iio-angle check a.sigmf-meta
  local name
  for name in other.sigmf-data other.sigmf-meta ./other.sigmf-data; do
    refused other.sigmf-data iio-angle calibrate single a.sigmf-meta -o "$name"
    refused other.sigmf-data iio-angle convert --calibration a.toml a.sigmf-meta -o "$name"
    refused other.sigmf-data iio-angle diagnose --report "$name" a.sigmf-meta
    refused other.sigmf-data iio-angle diagnose --heldout a.sigmf-meta --extend "$name" a.csv
    refused other.sigmf-data iio-angle calibrate dual a.csv a.sigmf-meta -o "$name"
  done
}

check_devices_and_pipes_may_be_read_and_written() {
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o /dev/null
  # shellcheck disable=SC2002
  cat a.csv | iio-angle calibrate single - -o a.toml >out 2>err || fail "a pipe: $(cat err)"
}

# A pipe need not have an end: that is said by its name before the memory is at its own.
check_a_pipe_without_an_end_is_refused_and_not_held() {
  # The runtime of a sanitizer takes more room than any limit leaves.
  ! ldd "$BUILD/tools/iio-angle" 2>&1 | grep -q 'lib[at]san' || return 0
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  mkfifo p.csv
  endless() {
    head -12 a.csv
    yes "$(sed -n 13p a.csv)"
  }
  limited_memory() { # limited_memory COMMAND...: in a gigabyte
    bash -c 'ulimit -v 1000000; exec "$@"' limited "$@"
  }
  local verb name
  for verb in "check" "calibrate single -o x.toml" "convert --calibration a.toml -o x.csv" \
    "diagnose"; do
    for name in - p.csv; do
      if [[ $name == - ]]; then
        # shellcheck disable=SC2086
        endless 2>/dev/null | limited_memory iio-angle $verb - >out 2>err
        same "exit status of '$verb -'" "${PIPESTATUS[1]}" 1
        says err '^iio-angle: standard input: this has no end after [0-9]+ rows'
      else
        (endless >p.csv 2>/dev/null) &
        # shellcheck disable=SC2086
        status 1 limited_memory iio-angle $verb p.csv
        wait
        says err '^iio-angle: p.csv: this has no end after [0-9]+ rows'
      fi
      same "sentences of '$verb $name'" "$(lines err)" 1
      empty out
    done
  done
  yes a.csv | limited_memory iio-angle study run --list - -o x.db >out 2>err
  same "exit status of study" "${PIPESTATUS[1]}" 1
  says err '^iio-angle: standard input: this is no list of names'
  absent x.toml x.csv x.db
  # One that ends is read, also by a verb that looks at the beginning first.
  cat a.csv >p.csv &
  status 0 iio-angle import p.csv -o y.csv
  wait
  same "rows imported" "$(grep -c '^[0-9]' y.csv)" "$(grep -c '^[0-9]' a.csv)"
}

check_closed_descriptors_do_no_harm() {
  capture a.csv
  iio-angle calibrate single a.csv -o good.toml >out 2>err
  local how
  for how in ">&-" "2>&-" ">&- 2>&-" "<&-" "<&- >&- 2>&-" "2>/dev/full"; do
    rm -f e.toml
    bash -c "iio-angle calibrate single a.csv -o e.toml $how" >out 2>err
    same "exit status with $how" $? 0
    status 0 iio-angle convert --calibration e.toml a.csv -o angles.csv
    same "model with $how" "$(grep -v -e '^date' -e checksum e.toml)" \
      "$(grep -v -e '^date' -e checksum good.toml)"
  done
  for how in "2>&-" "2>/dev/full"; do
    bash -c "iio-angle check nowhere.csv $how" >out 2>err
    same "exit status of a failure with $how" $? 1
  done
}

check_a_failed_write_to_standard_output_is_1_in_every_verb() {
  [[ -w /dev/full ]] || return 0
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  emulate
  local verb
  for verb in "--help" "--version" "record --help" "catalogue" "figures mismatch -o ." \
    "check a.csv" "check --json a.csv" "calibrate single a.csv -o b.toml" \
    "convert --calibration a.toml a.csv -o -" "simulate --duration 1 -o -" \
    "diagnose --json a.csv" "list -u $URI" "read -u $URI --samples 1000 --format csv" \
    "record -u $URI --samples 10 -o -" "watch -u $URI" "emulate"; do
    # shellcheck disable=SC2086
    timeout 300 iio-angle $verb >/dev/full 2>err </dev/null
    same "exit status of '$verb'" $? 1
    says err 'standard output: cannot write: No space left on device'
    same "sentences of '$verb'" "$(grep -c '^iio-angle: ' err)" 1
    ! grep '^ERROR: ' err || fail "'$verb' hands on what a library printed"
  done
}

check_a_pipe_that_nobody_reads_is_1_in_every_verb() {
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  local verb
  for verb in "catalogue" "simulate -o -" \
    "read --calibration a.toml --capture a.csv --speed 0 --format csv" \
    "convert --calibration a.toml a.csv -o -"; do
    # shellcheck disable=SC2086
    (sleep 0.3; exec iio-angle $verb) 2>err </dev/null | true
    same "exit status of '$verb'" "${PIPESTATUS[0]}" 1
    says err '^iio-angle: standard output: cannot write: Broken pipe$'
    same "sentences of '$verb'" "$(lines err)" 1
  done
}

# libiio and libxml2 print what a server sends, as it came.
check_a_server_that_breaks_off_costs_one_line() {
  local answer
  for answer in '' '0.24.v0.24\n' '-5\n' '20\n<?xml version="1.0"?>' '7\n<a>\033]0' 'x\n'; do
    cat >server.py <<EOF
import socket
s = socket.create_server(("127.0.0.1", 0))
print(s.getsockname()[1], flush=True)
while True:
    c = s.accept()[0]
    c.recv(100)
    c.sendall(b'$answer')
    c.close()
EOF
    rm -f port
    /usr/bin/python3 server.py >port 2>server.log &
    local server=$!
    until_there test -s port
    local verb
    for verb in "list" "read --samples 1"; do
      # shellcheck disable=SC2086
      status 1 timeout 100 iio-angle $verb -u "ip:127.0.0.1:$(cat port)"
      same "lines of '$verb' at '$answer'" "$(lines err)" 1
      says err '^iio-angle: '
    done
    kill $server
    wait $server 2>/dev/null
  done
}

check_two_recordings_under_one_name_are_both_kept() {
  emulate
  local old
  for old in no yes; do
    rm -f ./*.csv
    [[ $old == no ]] || capture rs.csv
    recording rs.csv
    status 0 iio-angle record -u "$URI" --samples 500 -o rs.csv
    kill "$RECORDER"
    wait "$RECORDER"
    same "exit status of the other one" $? 1
    says record.err '^iio-angle: .*rs\.csv: another program has written this file meanwhile; the recording is in .*rs\.1\.csv$'
    same "rows of the first to end" "$(grep -c '^[0-9]' rs.csv)" 500
    status 0 iio-angle check rs.1.csv
  done
}

check_permissions_are_kept_and_new_files_follow_the_umask() {
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  umask 027
  local file command
  for file in angles.csv model.toml capture.csv capture.sigmf-data capture.sigmf-meta; do
    case $file in
      angles.csv) command="convert --calibration a.toml a.csv -o" ;;
      model.toml) command="calibrate single a.csv -o" ;;
      *) command="simulate --duration 1 -o" ;;
    esac
    # shellcheck disable=SC2086
    status 0 iio-angle $command "$file"
    same "mode of a new $file" "$(stat -c %a "$file")" 640
    chmod 600 "$file"
    # shellcheck disable=SC2086
    status 0 iio-angle $command "$file"
    same "mode of a replaced $file" "$(stat -c %a "$file")" 600
  done
}

check_a_dangling_link_is_followed() {
  capture a.csv
  mkdir folder
  ln -s folder/target.toml link.toml
  status 0 iio-angle calibrate single a.csv -o link.toml
  [[ -L link.toml ]] || fail "the link was replaced"
  [[ -s folder/target.toml ]] || fail "the link was not followed"
  ln -s no-folder/target.toml nowhere.toml
  status 1 iio-angle calibrate single a.csv -o nowhere.toml
  says err 'nowhere.toml: cannot create: No such file'
  [[ -L nowhere.toml ]] || fail "the link was replaced"
  ln -s loop.toml loop.toml
  status 1 iio-angle calibrate single a.csv -o loop.toml
  says err 'loop.toml'
}

# as_outsider COMMAND...: by one who may read everything and write only where all may: root would not
# notice where a file is meant to go.
as_outsider() {
  if [[ $(id -u) == 0 ]]; then
    setpriv --reuid 65534 --regid 65534 --clear-groups --inh-caps +dac_read_search \
      --ambient-caps +dac_read_search "$@"
  else
    "$@"
  fi
}

check_a_bare_name_is_a_file_of_this_folder() {
  capture a.csv
  mkdir open shut
  chmod 777 open
  chmod 555 shut
  status 0 as_outsider env -C open iio-angle calibrate single ../a.csv -o sensor.toml
  status 0 as_outsider env -C open iio-angle convert --calibration sensor.toml ../a.csv -o ./b.csv
  local name
  for name in sensor.toml ./sensor.toml ../shut/sensor.toml; do
    status 1 as_outsider env -C shut iio-angle calibrate single ../a.csv -o $name
    empty out
    same "sentences" "$(lines err)" 1
    says err "^iio-angle: $name: cannot create: Permission denied"
  done
  chmod 755 shut
}

check_data_is_1_and_usage_2() {
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  head -14 a.csv >few.csv
  local verb
  for verb in "calibrate single few.csv -o x.toml" "calibrate dual few.csv few.csv -o x.toml"; do
    # shellcheck disable=SC2086
    status 1 iio-angle $verb
    empty out
    same "sentences of '$verb'" "$(lines err)" 1
  done
  absent x.toml
  # A value out of its range is the file's fault, not the command line's.
  sed -e '/checksum/d' -e 's/^amplitude_v.*/amplitude_v = -1.0/' a.toml >bad.toml
  for verb in "convert --calibration bad.toml a.csv -o x.csv" "simulate --model bad.toml -o x.csv" \
    "diagnose --model bad.toml a.csv" "check --calibration bad.toml a.csv"; do
    # shellcheck disable=SC2086
    status 1 iio-angle $verb
    says err 'bad\.toml'
  done
  absent x.csv
  for verb in "simulate -o x.txt" "simulate --effect weak-field:q=99 -o x.csv" \
    "simulate --duration 0 -o x.csv" "record -u ip:127.0.0.1:1 --continue --samples 1"; do
    # shellcheck disable=SC2086
    status 2 iio-angle $verb
  done
}

# A name of a file, and what it quotes, has no power over a terminal, and does not end a line.
check_names_are_printed_on_one_line_and_without_control_characters() {
  local odd=$'a\e[31m\nQb'
  capture "$odd.csv"
  status 0 iio-angle calibrate single "$odd.csv" -o "$odd.toml"
  says err '^written: a\\x1b\[31m\\nQb\.toml$'
  sed -i 's/^# supply_v = .*/# supply_v = 4/' "$odd.csv"
  local verb
  for verb in "check $odd.csv" "check $odd.c" "check --model$odd x" "$odd" "simulate -o $odd" \
    "diagnose $odd.csv --model $odd.toml" "convert $odd.csv -o x.csv --calibration $odd.c" \
    "simulate -o x.csv --effect $odd" "study run -o x.db $odd.c" "list -s $odd" "list -u $odd"; do
    local words
    IFS=' ' read -r -d '' -a words <<<"$verb" || true
    words[-1]=${words[-1]%$'\n'}
    iio-angle "${words[@]}" >out 2>err </dev/null
    ! grep -q $'\e' out err || fail "'${verb%% *}' hands on control characters: $(cat -v out err)"
    ! grep -q '^Qb' out err || fail "'${verb%% *}' breaks the line: $(cat -v out err)"
  done
}

check_what_is_implausible_is_said_beside_a_result() {
  capture a.csv
  sed -i 's/^# supply_v = .*/# supply_v = 4/' a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  says err '^but a.csv is not sound'
  says err '^supply +failed .*4.000 V is stated'
  status 1 iio-angle diagnose --report a.html a.csv # what the volts cannot be proves nothing
  says out '^The capture is not sound:'
  says out '^  supply: .*4.000 V is stated'
  says a.html 'id="failed-checks".*<li><code>supply</code> .*4.000 V is stated'
}

# A model follows the volts wherever they lie: that it does is no proof that nothing is wrong.
check_what_is_implausible_is_no_absence_of_discrepancies() {
  capture sound.csv
  sed 's/^# supply_v = .*/# supply_v = 4/' sound.csv >supply.csv
  awk -F, -v OFS=, '/^[0-9]/ {$2 = 2.5 + ($2 - 2.5) / 50; $3 = 2.5 + ($3 - 2.5) / 50} 1' \
    sound.csv >amplitude.csv
  local check
  for check in supply amplitude; do
    status 1 iio-angle diagnose --json $check.csv
    says out '"verdict": "insufficient-data"'
    says out "\"check\": \"$check\""
    ! grep -q '"verdict": "no-discrepancy"' out || fail "$check: $(cat out)"
  done
  status 0 iio-angle diagnose --json sound.csv
  says out '"failed_checks": \[\],'
}

# limited COMMAND...: no file may grow beyond a few kilobytes.
limited() {
  bash -c 'ulimit -f 8; exec "$@"' limited "$@"
}

check_a_limit_of_the_size_of_files_is_a_failed_write() {
  capture a.csv
  local words
  emulate
  for words in "simulate --duration 1 -o x.csv" "simulate --duration 1 -o x.sigmf-meta" \
    "diagnose a.csv --report x.html" "record -u $URI --samples 3000 -o x.csv"; do
    # shellcheck disable=SC2086
    status 1 limited iio-angle $words
    says err 'File too large'
    same "sentences of '$words'" "$(grep -c '^iio-angle: ' err)" 1
  done
  [[ -z $(find . -name 'x.*') ]] || fail "left behind: $(ls)"
}

# A shell's variable that was not set must not lose the report that was asked for.
check_nothing_given_is_wrong_usage() {
  capture a.csv
  local words arguments
  for words in "check|" "|a.csv" "diagnose|a.csv|--report|" "diagnose|a.csv|--report=" \
    "calibrate|single|a.csv|-o|" "read|-s||--samples|1"; do
    IFS='|' read -ra arguments <<<"$words|end"
    status 2 iio-angle "${arguments[@]:0:${#arguments[@]}-1}"
    says err "nothing is given"
    same "sentences of '$words'" "$(lines err)" 1
  done
  for words in "simulate|--duration|-1|-o|x.csv" "simulate|--rate|0|-o|x.csv" \
    "record|--samples|nan|-o|x.csv" "simulate|--motion|constant:rpm=1e300|-o|x.csv" \
    "simulate|--motion|ramp:from=0,to=-1e12|-o|x.csv"; do
    IFS='|' read -ra arguments <<<"$words"
    status 2 iio-angle "${arguments[@]}"
    says err "is not|must be from"
    [[ $(wc -c <err) -lt 200 ]] || fail "too many words: $(cat err)"
  done
  absent x.csv
}

# recording FILE [OPTIONS]: starts an endless one in the background, until its file grows.
recording() {
  local file=$1
  shift
  rm -f out
  iio-angle record -u "$URI" --duration 600 "$@" -o "$file" >record.out 2>record.err </dev/null &
  RECORDER=$!
  if [[ $file == *sigmf-meta ]]; then
    until_there test -s "${file%-meta}-data"
  else
    until_there written "$RECORDER"
  fi
}

check_every_signal_that_ends_it_keeps_the_recording() {
  emulate
  local signal file
  for signal in INT TERM HUP; do
    for file in $signal.csv $signal.sigmf-meta; do
      recording "$file"
      kill -s $signal "$RECORDER"
      [[ $signal == INT ]] || kill -s $signal "$RECORDER" 2>/dev/null # comes twice of itself
      wait "$RECORDER"
      same "exit status after $signal" $? 0
      status 0 iio-angle check "$file"
    done
  done
  trap '' HUP
  recording nohup.csv
  trap - HUP
  kill -s HUP "$RECORDER"
  sleep 0.5
  kill -0 "$RECORDER" || fail "nohup does not hold"
  kill -s TERM "$RECORDER"
  wait "$RECORDER"
  same "exit status after nohup" $? 0
}

check_a_recording_that_is_killed_is_kept_and_can_go_on() {
  emulate
  recording a.sigmf-meta
  sleep 1
  kill -9 "$RECORDER"
  wait "$RECORDER" 2>/dev/null
  says a.sigmf-meta unfinished
  printf 'xyz' >>a.sigmf-data # part of a frame
  status 0 iio-angle check --json a.sigmf-meta
  same "files" "$(find . -name '*sigmf*' | wc -l)" 2
  local before after
  before=$(stat -c %s a.sigmf-data)
  status 0 iio-angle record -u "$URI" --samples 500 --continue -o a.sigmf-meta
  after=$(stat -c %s a.sigmf-data)
  ((after > before)) || fail "it did not go on: $before, then $after bytes"
  ! grep -q unfinished a.sigmf-meta || fail "it is still unfinished"
  same segments "$(grep -c core:sample_start a.sigmf-meta)" 2
  status 0 iio-angle calibrate single a.sigmf-meta -o a.toml
  # And a finished one goes on, too; one that is not there begins.
  status 0 iio-angle record -u "$URI" --samples 500 --continue -o a.sigmf-meta
  same segments "$(grep -c core:sample_start a.sigmf-meta)" 3
  status 0 iio-angle record -u "$URI" --samples 500 --continue -o b.sigmf-meta
  status 0 iio-angle calibrate single b.sigmf-meta -o b.toml
}

check_what_cannot_go_on_stays_as_it_is() {
  emulate
  status 0 iio-angle record -u "$URI" --samples 500 -o a.sigmf-meta
  capture b.sigmf-meta
  refused_to_go_on() { # refused_to_go_on FILE [OPTIONS]
    local before
    before=$(cat "$1" "${1%-meta}-data" | cksum)
    status 1 iio-angle record -u "$URI" --samples 5 "${@:2}" --continue -o "$1"
    says err "$1|${1%-meta}-data"
    same "$1" "$(cat "$1" "${1%-meta}-data" | cksum)" "$before"
  }
  refused_to_go_on b.sigmf-meta                 # in another form
  refused_to_go_on a.sigmf-meta --supply 3.3
  # The device keeps the rate at which it was found.
  refused_to_go_on a.sigmf-meta --rate 1000
  says err 'sample rate is 10000 Hz, now it would be 1000 Hz'
  status 0 iio-angle record -u "$URI" --samples 5 --continue -o a.sigmf-meta
  printf 'X' | dd of=a.sigmf-data bs=1 seek=100 conv=notrunc 2>/dev/null
  refused_to_go_on a.sigmf-meta                 # damaged
  status 2 iio-angle record -u "$URI" --samples 5 --continue -o c.csv
  absent c.csv
}

check_two_recorders_do_not_share_a_file() {
  emulate
  recording a.sigmf-meta
  status 1 iio-angle record -u "$URI" --samples 5 --continue -o a.sigmf-meta
  says err 'another program is recording'
  status 1 iio-angle simulate --duration 1 -o a.sigmf-meta
  says err 'another program is recording'
  kill "$RECORDER"
  wait "$RECORDER"
  same "exit status" $? 0
  status 0 iio-angle check --json a.sigmf-meta
  same "files" "$(find . -name '*sigmf*' | wc -l)" 2
}

check_a_recording_takes_the_place_of_an_old_one_only_when_it_is_complete() {
  emulate
  capture a.sigmf-meta
  local before
  before=$(cat a.sigmf-meta a.sigmf-data | cksum)
  iio-angle record -u "$URI" --duration 600 -o a.sigmf-meta >record.out 2>record.err </dev/null &
  RECORDER=$!
  local i
  for ((i = 0; i < 600; i++)); do
    [[ $(find . -name '*sigmf*' | wc -l) -lt 4 ]] || break
    sleep 0.05
  done
  same "the old one meanwhile" "$(cat a.sigmf-meta a.sigmf-data | cksum)" "$before"
  kill "$RECORDER"
  wait "$RECORDER"
  same "exit status" $? 0
  same "files" "$(find . -name '*sigmf*' | wc -l)" 2
  status 0 iio-angle calibrate single a.sigmf-meta -o a.toml
  [[ $(cat a.sigmf-meta a.sigmf-data | cksum) != "$before" ]] || fail "the new one is not there"
}

check_where_nothing_can_be_written_is_said_before_the_work() {
  status 0 iio-angle simulate --seed 4571 --duration 30 -o a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  mkdir folder.csv folder.html folder.toml
  refuses() { # refuses FILE COMMAND...: soon, with one sentence about it and no result
    local file=$1 began=$SECONDS
    shift
    status 1 "$@"
    says err "^iio-angle: $file: cannot (create|write): "
    same "sentences of '$*'" "$(lines err)" 1
    empty out
    ((SECONDS - began < 3)) || fail "'$*' worked for $((SECONDS - began)) s first"
  }
  local end
  for end in /nowhere/x $PWD/a.csv/x nowhere/x folder; do
    refuses "$end.html" iio-angle diagnose --report "$end.html" a.csv
    refuses "$end.toml" iio-angle diagnose --extend "$end.toml" a.csv
    refuses "$end.toml" iio-angle diagnose --extend "$end.toml" --report y.html a.csv
    refuses "$end.toml" iio-angle calibrate single a.csv -o "$end.toml"
    refuses "$end.toml" iio-angle calibrate dual a.csv a.csv -o "$end.toml"
    refuses "$end.toml" iio-angle simulate --save-model "$end.toml" -o b.csv
    refuses "$end.csv" iio-angle simulate --duration 1000 -o "$end.csv"
    refuses "$end.csv" iio-angle convert --calibration a.toml a.csv -o "$end.csv"
    refuses "$end.csv" iio-angle import a.csv -o "$end.csv"
  done
  refuses nowhere/x.db iio-angle study run a.csv -o nowhere/x.db
  absent y.html b.csv
  # What is written in place, or behind a link, is none of that.
  ln -s there.toml link.toml
  status 0 iio-angle calibrate single a.csv -o link.toml
  [[ -s there.toml ]] || fail "nothing behind the link"
  status 0 iio-angle convert --calibration a.toml a.csv -o /dev/null
  if ((EUID != 0)); then
    mkdir closed
    chmod a-w closed
    refuses closed/x.html iio-angle diagnose --report closed/x.html a.csv
  fi
}

run_checks "${2:-}"
