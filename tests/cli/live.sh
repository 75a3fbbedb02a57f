#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# live.sh BUILD [PATTERN]: iio-angle as a user runs it, on the simulated sensor that another
# iio-angle serves over the network.
set -u
BUILD=$(cd "$1" && pwd)
PATH=$BUILD/tools:$BUILD/tools/examples:$PATH
TESTS=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"

# What libiio itself prints on standard error is no word of ours.
quiet() {
  grep -v '^ERROR: ' err >ours || true
  empty ours
}

# interrupted SIGNAL COMMAND...: like status 0, but with a signal once it has written something.
interrupted() {
  local signal=$1 got=0 pid
  shift
  rm -f out err
  "$@" >out 2>err </dev/null &
  pid=$!
  until_there written "$pid"
  kill -s "$signal" "$pid" || fail "'$*' ended before the signal: $(head -c 500 err)"
  wait "$pid" || got=$?
  [[ $got == 0 ]] || fail "'$*' ended with $got after the signal: $(head -c 500 err)"
}

check_list_names_the_device_and_its_channels() {
  emulate
  status 0 iio-angle list -u "$URI"
  says out 'vsin.*vcos'
  says out "iio-angle read -u $URI"
}

check_a_wrong_device_or_channel_is_answered_with_those_there_are() {
  emulate
  local verb
  for verb in read watch "record --samples 9 -o a.csv" "list --save wheel"; do
    # shellcheck disable=SC2086
    status 1 iio-angle $verb -u "$URI" --sin foo
    says err '^iio-angle: ada4571-sim \(iio:device0\) has no input channel "foo"; it has voltage0 \(vsin\), voltage1 \(vcos\)'
    # shellcheck disable=SC2086
    status 1 iio-angle $verb -u "$URI" -d ada4571-smi
    says err "^iio-angle: no IIO device \"ada4571-smi\"; there is ada4571-sim \(iio:device0\)[^;]*; did you mean 'ada4571-sim'"
    # shellcheck disable=SC2086
    status 1 iio-angle $verb -u "$URI" -d ada4571-sim --cos foo
    says err '"foo"; it has voltage0'
    ! grep -q 'did you mean' err || fail "the device is there: $(cat err)"
  done
  absent a.csv
}

check_what_is_stored_goes_where_names_are_looked_for() {
  emulate
  local XDG_CONFIG_HOME=$PWD/home name
  export XDG_CONFIG_HOME
  for name in ../evil ./wheel "$PWD/wheel.toml" a/b /; do
    status 2 iio-angle list -u "$URI" --save "$name"
    says err "^iio-angle: --save: '$name' is a path: give a name without a slash$"
  done
  for name in .. .hidden 'a b' 'a*'; do
    status 2 iio-angle list -u "$URI" --save "$name"
    says err '^iio-angle: --save: .* is no name for a configuration'
  done
  absent home evil evil.toml wheel wheel.toml
}

check_list_shows_one_device_and_json() {
  emulate
  status 0 iio-angle list -u "$URI" -d ada4571-sim
  says out 'vsin.*vcos'
  status 1 iio-angle list -u "$URI" -d ada4571-smi
  says err "no usable device is called 'ada4571-smi'; did you mean 'ada4571-sim'"
  status 0 iio-angle list -u "$URI" --json
  /usr/bin/python3 -c 'import json, sys
d = json.load(sys.stdin)
assert d["schema"] == "ada4571-list/1" and d["uri"] == sys.argv[1], d
assert [x["name"] for x in d["devices"]] == ["ada4571-sim"] and d["devices"][0]["labelled"], d
' "$URI" <out 2>json.err || fail "$(tail -1 json.err)"
}

check_a_stored_calibration_stays_until_it_is_asked_away() {
  emulate
  local XDG_CONFIG_HOME=$PWD/home
  export XDG_CONFIG_HOME
  stored() { grep -c "^file = .$PWD/$1.\$" home/ada4571/wheel.toml; }
  status 0 iio-angle simulate --duration 1 -o a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  status 0 iio-angle calibrate single a.csv -o b.toml
  status 1 iio-angle list -u "$URI" --save wheel --calibration nowhere.toml
  says err nowhere.toml
  status 1 iio-angle list -u "$URI" --save wheel --calibration a.csv
  absent home/ada4571/wheel.toml
  status 0 iio-angle list -u "$URI" --save wheel --calibration a.toml
  same "after the first" "$(stored a.toml)" 1
  printf '\n[pins]\ngc = "gc-line"\n' >>home/ada4571/wheel.toml
  status 0 iio-angle list -u "$URI" --supply 4.9V --save wheel
  same "after another supply" "$(stored a.toml)" 1
  says home/ada4571/wheel.toml '^gc = .gc-line.$'
  says err "calibrated by $PWD/a.toml"
  status 0 iio-angle list -s wheel --save wheel --calibration b.toml
  same "after another calibration" "$(stored b.toml)" 1
  status 0 iio-angle list -s wheel
  says out "iio-angle read -u $URI"
  status 0 iio-angle list -u "$URI" --save wheel --no-calibration
  same "after --no-calibration" "$(grep -c '^file' home/ada4571/wheel.toml)" 0
  echo nonsense >home/ada4571/wheel.toml
  status 1 iio-angle list -u "$URI" --save wheel
  same "what cannot be read" "$(cat home/ada4571/wheel.toml)" nonsense
}

check_record_without_a_length_goes_on_until_it_is_stopped() {
  emulate
  interrupted INT iio-angle record -u "$URI" -o a.csv
  status 0 iio-angle check a.csv
}

check_no_device_and_no_server_end_with_1() {
  status 1 iio-angle list -u ip:127.0.0.1:1
  empty out
  [[ -s err ]] || fail "no reason given"
  status 1 iio-angle read -u ip:127.0.0.1:1
  emulate
  status 1 iio-angle read -u "$URI" -d no-such-device
  says err no-such-device
  status 1 iio-angle record -u "$URI" -d ada4571-sim --sin no-such-channel --cos voltage1 --samples 1 -o x.csv
  says err no-such-channel
  absent x.csv
}

check_record_takes_as_many_or_as_long_as_asked() {
  emulate --temperature constant:deg_c=25
  status 0 iio-angle record -u "$URI" --samples 1234 -o a.csv
  same rows "$(column a.csv vsin_v | wc -l)" 1234
  empty out
  status 0 iio-angle record -u "$URI" --duration 0.5 -o b.csv
  same rows "$(column b.csv vsin_v | wc -l)" 5000
  status 0 iio-angle record -u "$URI" --samples 1000 -o c.sigmf-meta
  status 0 iio-angle check c.sigmf-meta
  iio-angle record -u "$URI" --samples 100 -o - 2>/dev/null >d.csv || fail "record -o -"
  same rows "$(column d.csv vsin_v | wc -l)" 100
}

check_read_gives_calibrated_angles_in_every_format() {
  emulate --temperature constant:deg_c=25
  status 0 iio-angle record -u "$URI" --duration 1 -o a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  status 0 iio-angle read -u "$URI" --calibration a.toml --samples 500 --format csv
  quiet
  same header "$(head -1 out)" time_s,angle_deg,radius,status
  same rows "$(lines out)" 501
  status 0 iio-angle read -u "$URI" --calibration a.toml --samples 500 --format json
  same rows "$(lines out)" 500
  /usr/bin/python3 -c 'import json, sys
for line in sys.stdin:
    a = json.loads(line)
    assert 0 <= a["angle_deg"] < 180 and abs(a["radius"] - 1) < 0.01 and a["status"] == 0, a' \
    <out 2>json.err || fail "$(tail -1 json.err)"
  status 0 iio-angle read -u "$URI" --calibration a.toml --samples 5000 --dynamic
  says out ' deg  radius 1\.0'
  same rows "$(lines out)" 5
  status 0 iio-angle read -u "$URI" --samples 10
  says err 'no calibration'
}

check_latency_is_measured_by_buffer_length() {
  emulate
  status 0 iio-angle read -u "$URI" --latency --buffers 1,2000 --samples 4000 --format csv
  same header "$(head -1 out)" buffer_frames,buffer_s,samples,median_s,p99_s,worst_s,worst_per_buffer,wake_ups_per_s,processor_share
  same lengths "$(column out buffer_frames | tr '\n' ' ')" "1 2000 "
  # The first sample of a buffer waits for all the others.
  awk -F, 'NR > 1 && !($6 >= ($1 - 1) / 10000 && $4 <= $5 && $5 <= $6) { exit 1 }' out ||
    fail "$(cat out)"
  status 0 iio-angle read -u "$URI" --latency --samples 500 --within 0.001
  same lengths "$(grep -c '^buffer of' out)" 3
  says out '^buffer of 10 samples, 1\.000 ms: .*worst'
  says out '#'
  status 2 iio-angle read -u "$URI" --buffers 3
}

check_the_closed_loop_works_with_the_newest_angle() {
  emulate
  export XDG_CONFIG_HOME=$PWD/config
  status 0 iio-angle record -u "$URI" --duration 1 -o a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  status 0 iio-angle list -u "$URI" --save wheel --calibration "$PWD/a.toml"
  status 0 closed_loop wheel 1
  says out '^[1-9][0-9]* wake-ups, oldest angle [0-9.]+ ms$'
  status 1 closed_loop no-such-name 1
}

check_signals_end_live_verbs_cleanly() {
  emulate
  interrupted INT iio-angle record -u "$URI" --duration 60 -o a.csv
  [[ -s a.csv ]] || fail "what was captured is lost"
  status 0 iio-angle check a.csv
  interrupted TERM iio-angle read -u "$URI" --format csv
  same "columns of the last line" "$(tail -1 out | awk -F, '{ print NF }')" 4
  interrupted INT iio-angle watch -u "$URI"
  says out ' deg  radius '
  interrupted INT iio-angle emulate
  says out '^ip:127\.0\.0\.1:[0-9]+$'
}

check_a_server_that_dies_ends_with_1_and_keeps_what_came() {
  emulate
  iio-angle record -u "$URI" --duration 60 -o a.csv >out 2>err </dev/null &
  local recorder=$! got=0
  until_there written "$recorder"
  stop_emulator
  wait "$recorder" || got=$?
  same "exit status" "$got" 1
  says err .
  [[ -s a.csv ]] || fail "what was captured is lost"
  status 0 iio-angle check a.csv
}

# away FILE: the emulator that serves a verb in the background, which writes FILE, goes and comes back.
away() {
  local port=${URI##*:}
  until_there test -s "$1"
  stop_emulator
  until_there grep -q '^lost: .*; trying again every second$' err
  rm uri
  emulate --temperature constant:deg_c=25 --port "$port"
  until_there grep -qE '^back after [0-9.]+ s: about [1-9][0-9]* samples missed$' err
}

check_record_goes_on_when_the_server_is_back_and_counts() {
  emulate --temperature constant:deg_c=25
  iio-angle record -u "$URI" --reconnect --samples 60000 -o a.sigmf-meta >out 2>err </dev/null &
  local recorder=$! got=0
  away a.sigmf-data
  wait "$recorder" || got=$?
  same "exit status" "$got" 0
  says err '^1 times away, about [1-9][0-9]* samples missed meanwhile$'
  # A try comes no sooner than a second after the loss: one step of the times is at least that.
  /usr/bin/python3 - <<'EOF' >said 2>&1 || fail "$(tail -1 said)"
import json
meta = json.load(open("a.sigmf-meta"))
parts, rate = meta["captures"], meta["global"]["core:sample_rate"]
gaps = [b["ada4571:time_s"] - a["ada4571:time_s"] - (b["core:sample_start"] - a["core:sample_start"]) / rate
        for a, b in zip(parts, parts[1:])]
assert max(gaps, default=0) >= 1 and min(gaps) > 0, gaps
EOF
}

# 1000 buffers of 100 samples, half of which count: one allocation a buffer would be 500.
check_record_allocates_nothing_while_it_runs() {
  # A program of another processor cannot load what is compiled here; sanitizers have a malloc of
  # their own.
  ldd "$BUILD/tools/iio-angle" >libraries 2>&1 || return 0
  ! grep -q 'lib[at]san' libraries || return 0
  cc -shared -fPIC -O1 -o allocations.so "$TESTS/allocations.c"
  emulate --temperature constant:deg_c=25 --rate 100k
  local file calls allocations
  for file in a.csv a.sigmf-meta; do
    rm -f count
    LD_PRELOAD=$PWD/allocations.so ALLOCATIONS=$PWD/count \
      iio-angle record -u "$URI" --within 0.001 --samples 100k -o $file 2>err || fail "$(cat err)"
    [[ -s count ]] || fail "nothing was counted"
    read -r calls allocations <count
    ((calls >= 500)) || fail "$file: $calls calls of recv and read are too few for 500 buffers"
    # On a loaded machine up to eight were seen, no more of a long recording than of a short one; one
    # for each buffer would be one of every two calls.
    ((allocations * 50 < calls)) || fail "$file: $allocations allocations while $calls calls received"
  done
}

check_read_goes_on_when_asked_and_watch_unasked() {
  emulate --temperature constant:deg_c=25
  local reader got
  for verb in "read --reconnect" watch; do
    rm -f out err
    # shellcheck disable=SC2086 # the verb and its options
    iio-angle $verb -u "$URI" >out 2>err </dev/null &
    reader=$! got=0
    away out
    kill -INT "$reader"
    wait "$reader" || got=$?
    same "exit status of $verb" "$got" 0
    awk 'NR > 1 && !($1 > last) { exit 1 } { last = $1 }' out || fail "$verb: the times do not go on"
    says err '^1 times away'
  done
  iio-angle watch --no-reconnect -u "$URI" >out 2>err </dev/null &
  reader=$! got=0
  until_there test -s out
  stop_emulator
  wait "$reader" || got=$?
  same "exit status without --reconnect" "$got" 1
}

check_a_stored_configuration_opens_the_device() {
  emulate --temperature constant:deg_c=25
  export XDG_CONFIG_HOME=$PWD/config
  status 0 iio-angle record -u "$URI" --duration 1 -o a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  status 0 iio-angle list -u "$URI" --save wheel --calibration "$PWD/a.toml"
  [[ -s config/ada4571/wheel.toml ]] || fail "nothing stored"
  status 0 iio-angle read -s wheel --samples 100 --format csv
  quiet
  same rows "$(lines out)" 101
  status 0 read_angle wheel
  says out ' deg$'
  status 1 iio-angle read -s no-such-name --samples 100
  says err no-such-name
}

check_a_closed_pipe_ends_read() {
  emulate
  local got
  got=$(timeout 20 bash -c "iio-angle read -u $URI --format csv 2>/dev/null | head -3 | wc -l")
  same "lines" "$got" 3
}

run_checks "${2:-}"
