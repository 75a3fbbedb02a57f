# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Captures on the local backend.

# shellcheck source=/dev/null
. "$HERE/captures.sh"

capture_duration() {
  frames turn 2000 1 >table
  use_table table
  start_capture out iio-angle record -d shaft --duration 0.1 -o capture.csv
  push "1024 100000 wait"
  ended "$CAPTURE" 20
  same rows "$(capture_rows capture.csv | wc -l)" 1000
}

# The reader stands still: the kernel keeps the oldest frames and tells nobody.
capture_overrun() {
  local pushed dropped lost
  frames turn 4096 1 >table
  use_table table
  start_capture out ada4571-kernel-probe frames "$URI" shaft 100000
  push "1000 100000 wait"
  kill -STOP "$CAPTURE"
  push "20000 100000"
  kill -CONT "$CAPTURE"
  pause 0.5
  push "5000 100000 wait"
  pause 0.5
  read -r pushed dropped <"$REPLAY.0/stats"
  between "frames dropped by the kernel" "$dropped" 1 20000
  push "$((100000 - pushed)) 100000 wait"
  ended "$CAPTURE" 60
  lost=$(tail -1 out)
  same statistics "$lost" "# frames 100000 lost $dropped gaps 1"
}

capture_no_trigger() {
  write 0 "$REPLAY.0/untriggered"
  echo >"$(iio_folder shaft)/trigger/current_trigger"
  expect 1 iio-angle record -d shaft --samples 10 -o none.csv 2>error
  contains error trigger
  one_line error
  same file "$(ls none.csv 2>/dev/null || true)" ""
}

# Ctrl-C is an ordinary end: what was captured is kept whole.
capture_interrupted() {
  frames turn 640 1 >table
  use_table table
  start_capture out iio-angle record -d shaft --samples 1000000 -o capture.csv
  push "640 100000 wait"
  pause 0.5
  kill -INT "$CAPTURE"
  ended "$CAPTURE" 5
  frames from capture.csv 1.25 >codes
  cmp table codes
}

# Unplugged while iio-angle records: an error, and the file has what came before.
capture_unplugged() {
  frames turn 640 1 >table
  use_table table
  start_capture out iio-angle record -d shaft --samples 1000000 -o capture.csv
  push "640 100000 wait"
  pause 0.5
  unplug 0
  expect 1 ended "$CAPTURE" 10
  contains out.err removed
  frames from capture.csv 1.25 >codes
  cmp table codes
  replug 0
}

# The simulated sensor on a grid of 16 bits over 8.192 V goes through the kernel and comes out the
# same, as text and as angles.
capture_simulated() {
  cp "$OUT/simulated.csv" .
  frames from simulated.csv 0.125 >table
  use_table table le:u16/16 0.125
  start_capture out iio-angle record -d shaft --samples "$(capture_rows simulated.csv | wc -l)" \
    -o replayed.csv
  push "$(($(stat -c %s table) / 16)) 100000 wait"
  ended "$CAPTURE" 60
  for name in vsin_v vcos_v vtemp_v vdd_v; do
    cmp <(column simulated.csv $name | awk '{printf "%.7f\n", $1}') \
      <(column replayed.csv $name | awk '{printf "%.7f\n", $1}')
  done
  expect 0 iio-angle calibrate single simulated.csv -o sensor.toml
  expect 0 iio-angle convert --calibration sensor.toml simulated.csv -o a.csv
  expect 0 iio-angle convert --calibration sensor.toml replayed.csv -o b.csv
  cmp a.csv b.csv
}

load_replay devices=1 labels=shaft
for format in le:u12/16'>>'4 be:u12/16'>>'4 le:s16/16 be:s16/16 le:u24/32 be:s24/32'>>'8 \
    be:s32/32 "le:u24/32 le:u16/16 be:s12/16>>4 be:u24/32>>8"; do
  check "the library decodes ${format// /, } bit for bit" capture_format "$format"
done
check "record writes the codes and times that were injected" capture_record
check "record by duration ends by the device's own clock" capture_duration
check "a SigMF capture gives the same angles as text" capture_sigmf
check "record, calibrate, convert and live read agree on the angles" capture_job
check "lost frames are counted exactly from the time stamps" capture_losses
check "frames lost by an overrun are counted exactly" capture_overrun
check "a clock that is set back is bridged" capture_clock_back
check "a time-out is no end, and loses nothing" capture_timeout
check "a missing trigger is one clear sentence" capture_no_trigger
check "cancel from another thread ends a read at once" capture_cancel
check "unplug ends the capture with its error, replug and start go on" capture_replug
check "record keeps what came before an unplug, and fails" capture_unplugged
check "record keeps what came before Ctrl-C" capture_interrupted
check "calibration goes into calibbias and calibscale and comes back" capture_calibbias
check "the simulated sensor through the kernel gives the file's angles bit for bit" capture_simulated
