#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# replay.sh BUILD [PATTERN]: a capture in the place of a device, and sources in event loops.
set -u
BUILD=$(cd "$1" && pwd)
PATH=$BUILD/tools:$BUILD/tools/examples:$PATH
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"

simulate() {
  iio-angle simulate --seed 4571 --duration 2 --motion constant:rpm=60 -o a.csv 2>err || fail "$(cat err)"
  iio-angle calibrate single a.csv -o a.toml 2>err || fail "$(cat err)"
}

check_read_plays_a_capture_and_gives_what_convert_gives() {
  simulate
  status 0 iio-angle convert --calibration a.toml a.csv -o angles.csv
  status 0 iio-angle read --capture a.csv --speed 0 --calibration a.toml --format csv
  cmp -s out angles.csv || fail "$(diff out angles.csv | head -3)"
  empty err
  status 0 iio-angle read --capture a.csv --speed 20 --calibration a.toml
  same "ten lines a second of the recording" "$(lines out)" 20
}

check_a_calibration_is_taken_to_the_supply_of_the_frames() {
  simulate
  awk -F, -v OFS=, '
    /^# supply_v/ {print "# supply_v = 4"; next}
    /^#/ {print; next}
    !names {for (i = 1; i <= NF; ++i) if ($i ~ /_v$/) volts[i] = 1; names = 1; print; next}
    {for (i in volts) $i *= 0.8; print}' a.csv >at4.csv
  status 0 iio-angle convert --calibration a.toml at4.csv -o angles.csv
  status 0 iio-angle read --capture at4.csv --speed 0 --calibration a.toml --format csv
  cmp -s out angles.csv || fail "$(diff out angles.csv | head -3)"
  same "radius at 4 V" "$(awk -F, 'NR > 1 {sum += $3} END {printf "%.2f", sum / (NR - 1)}' out)" 1.00
  sed 's/^# periods_per_turn = 2/# periods_per_turn = 3/' a.csv >three.csv
  status 1 iio-angle read --capture three.csv --calibration a.toml
  says err 'the calibration is for periods_per_turn = 2, the source says 3'
}

check_what_a_capture_says_itself_is_refused_beside_it() {
  simulate
  status 2 iio-angle read --capture a.csv -u ip:127.0.0.1
  status 2 iio-angle watch --capture a.csv --periods 1
  status 2 iio-angle emulate --capture a.csv --seed 3
  status 2 iio-angle read --speed 2
  status 2 iio-angle read --capture a.csv --speed -1
  status 2 iio-angle read --capture a.csv --latency
  status 1 iio-angle read --capture no-such-file.csv
}

check_watch_prints_lines_where_there_is_no_terminal() {
  simulate
  status 0 iio-angle watch --capture a.csv --speed 0 --calibration a.toml
  says out ' deg  radius 1\.0'
}

emulate_capture() {
  iio-angle emulate "$@" >uri 2>emulator.log </dev/null &
  EMULATOR=$!
  local i
  for ((i = 0; i < 200; i++)); do
    [[ ! -s uri ]] || break
    sleep 0.05
  done
  URI=$(head -1 uri)
}

check_emulate_makes_a_device_of_a_capture() {
  simulate
  emulate_capture --capture a.csv --speed 2
  status 0 iio-angle record -u "$URI" --samples 20000 -o b.csv
  for name in vsin_v vcos_v vtemp_v; do
    same "$name" "$(column b.csv $name | md5sum)" "$(column a.csv $name | md5sum)"
  done
  says b.csv '^# sample_rate_hz = 20000$'
  same serial "$(iio_attr -u "$URI" -C hw_serial 2>/dev/null | grep -c 'simulated-4571')" 1
}

check_a_capture_that_is_served_ends_and_does_not_begin_again() {
  simulate
  emulate_capture --capture a.csv --speed 4
  status 0 iio-angle record -u "$URI" -o b.csv
  says err '^the samples are over: the server plays a recording'
  same samples "$(column b.csv vsin_v | md5sum)" "$(column a.csv vsin_v | md5sum)"
  status 0 iio-angle record -u "$URI" --duration 0.5 -o c.csv
  same "samples of all of it" "$(column c.csv vsin_v | wc -l)" 20000
  for length in "--duration 1" "--samples 20001"; do
    # shellcheck disable=SC2086
    status 1 iio-angle record -u "$URI" $length -o c.csv
    says err 'were over after 20000 of them, 0.500 s: what was asked for is not there$'
    same "samples kept with $length" "$(column c.csv vsin_v | wc -l)" 20000
  done
  status 0 iio-angle read -u "$URI" --calibration a.toml --format csv
  same "lines of read" "$(lines out)" 20001
  status 1 iio-angle read -u "$URI" --latency --buffers 100
  says err 'were over before the latency was measured'
}

check_the_examples_wait_for_frames_and_end_with_the_capture() {
  simulate
  sleep 30 | timeout 20 poll_angle a.csv >out 2>err || fail "poll_angle: $(cat err)"
  says out '^ +1\.9[0-9]* s +[0-9.]+ deg$'
  (($(lines out) > 20)) || fail "only $(lines out) wake-ups in two seconds"
  status 1 poll_angle no-such-file.csv
  if [[ -x $BUILD/tools/examples/sd_event_angle ]]; then
    status 0 timeout 20 sd_event_angle a.csv
    says out '^ +2\.000 s +[0-9.]+ V'
  fi
}

run_checks "${2:-}"
