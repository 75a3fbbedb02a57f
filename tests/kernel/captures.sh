# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Checks of a capture that hold on the local backend and over the network alike.

capture_format() {
  frames table "$1" 640 >table
  use_table table "$1" 0.298023224
  start_capture out ada4571-kernel-probe frames "$URI" shaft 640
  push "640 100000 wait"
  ended "$CAPTURE" 30
  frames verify out table 0.298023224 100000
}

capture_record() {
  frames turn 640 1 >table
  use_table table
  start_capture out iio-angle record -u "$URI" -d shaft --samples 600 -o capture.csv
  push "640 100000 wait"
  ended "$CAPTURE" 30
  same rows "$(capture_rows capture.csv | wc -l)" 600
  frames from capture.csv 1.25 >codes
  head -c $((600 * 16)) table | cmp - codes
  same "last time" "$(column capture.csv time_s | tail -1 | sed 's/0*$//')" 0.0599
}

# The SigMF form holds what the converter delivered: the same angles come of it.
capture_sigmf() {
  frames turn 640 1 >table
  use_table table be:u12/16'>>'4
  start_capture out iio-angle record -u "$URI" -d shaft --samples 640 -o capture.sigmf-meta
  push "640 100000 wait"
  ended "$CAPTURE" 30
  start_capture out iio-angle record -u "$URI" -d shaft --samples 640 -o capture.csv
  push "640 100000 wait"
  ended "$CAPTURE" 30
  expect 0 iio-angle calibrate single capture.csv -o sensor.toml
  expect 0 iio-angle convert --calibration sensor.toml capture.sigmf-meta -o a.csv
  expect 0 iio-angle convert --calibration sensor.toml capture.csv -o b.csv
  same rows "$(capture_rows a.csv | wc -l)" 640
  cmp a.csv b.csv
}

# record, calibrate, read and convert as a user would; the magnet turns a degree a frame.
capture_job() {
  frames turn 1280 1 >table
  use_table table
  start_capture out iio-angle record -u "$URI" -d shaft --samples 1280 -o capture.csv
  push "1280 100000 wait"
  ended "$CAPTURE" 30
  expect 0 iio-angle calibrate single capture.csv -o sensor.toml
  expect 0 iio-angle convert --calibration sensor.toml capture.csv -o angles.csv
  start_capture live.csv iio-angle read -u "$URI" -d shaft --calibration sensor.toml \
    --format csv --samples 1280
  push "1280 100000 wait"
  ended "$CAPTURE" 30
  # Half a code of 1187 is 0.012 degrees of the field; no filter, no delay.
  for file in angles.csv live.csv; do
    same "rows of $file" "$(capture_rows $file | wc -l)" 1280
    column $file angle_deg | awk '
      {e = $1 - (NR - 1) % 180; if (e > 90) e -= 180; if (e < -90) e += 180
       if (e > 0.03 || e < -0.03) {print "row " NR ": " $1; bad = 1}}
      END {exit bad}' | head -3
  done
  same "status of sound samples" "$(column angles.csv status | sort -u)" 0
  column angles.csv angle_deg >converted
  column live.csv angle_deg >live
  cmp converted live
}

capture_losses() {
  frames turn 4000 1 >table
  use_table table
  start_capture out ada4571-kernel-probe frames "$URI" shaft 1280
  push "500 100000 wait"
  control "write 37 $REPLAY.0/lose"
  push "400 100000 wait"
  control "write 1 $REPLAY.0/lose"
  push "418 100000 wait"
  ended "$CAPTURE" 30
  same statistics "$(tail -1 out)" "# frames 1280 lost 38 gaps 2"
}

capture_clock_back() {
  frames turn 1280 1 >table
  use_table table
  start_capture out ada4571-kernel-probe frames "$URI" shaft 1280
  push "640 100000 wait"
  control "write -3600000000000 $REPLAY.0/step"
  push "640 100000 wait"
  ended "$CAPTURE" 30
  same statistics "$(tail -1 out)" "# frames 1280 lost 0 gaps 1"
  frames verify out table 1.25 100000
}

capture_timeout() {
  frames turn 640 1 >table
  use_table table
  start_capture out ada4571-kernel-probe timeout "$URI" shaft 300 640
  wait_for 10 test -s out
  push "640 100000 wait"
  ended "$CAPTURE" 30
  # Outcome 1 is a time-out, an ordinary event.
  contains out "outcome 1 count 0"
  between "waited" "$(sed -n 's/.*after \([0-9.]*\) s/\1/p' out)" 0.29 0.6
  tail -n +2 out >rows
  frames verify rows table 1.25 100000
}

capture_cancel() {
  local delay
  frames turn 640 1 >table
  use_table table
  expect 0 ada4571-kernel-probe cancel "$URI" shaft >out
  contains out "outcome 3"
  delay=$(sed -n 's/.*after \([0-9.]*\) s/\1/p' out)
  between "delay" "$delay" 0 0.1
}

# One handle: a capture, the device goes, comes back under its name, and is started again.
capture_replug() {
  frames turn 640 1 >table
  use_table table
  mkfifo go
  ada4571-kernel-probe replug "$URI" shaft 640 >out 2>error <go &
  CAPTURE=$!
  exec 5>go
  control "wait_for 20 running"
  push "640 100000 wait"
  wait_for 10 grep -q before out
  control "unplug 0"
  wait_for 20 grep -q ended out || fail "the capture goes on without the device: $(cat out error)"
  contains out "ended ADA4571_ERROR_DISCONNECTED"
  control "replug 0"
  use_table table
  echo go >&5
  exec 5>&-
  control "wait_for 20 running"
  push "640 100000 wait"
  ended "$CAPTURE" 30 || { cat out error; return 1; }
  contains out "again 640"
}

# The magnet turns with offsets; what calibrates it goes into the converter and comes back.
capture_calibbias() {
  local folder bias_sin bias_cos
  frames turn 1280 1 >table
  use_table table
  start_capture out iio-angle record -u "$URI" -d shaft --samples 1280 -o capture.csv
  push "1280 100000 wait"
  ended "$CAPTURE" 30
  expect 0 iio-angle calibrate single capture.csv -o sensor.toml >found
  expect 0 ada4571-kernel-probe calibration "$URI" shaft sensor.toml >kept
  # Mid-supply, 2.5 V, is code 2000 of 1.25 mV; the magnet's middle is code 2048.
  control 'cat $(iio_folder shaft)/in_voltage0_calibbias $(iio_folder shaft)/in_voltage1_calibbias' \
    | xargs >bias
  read -r bias_sin bias_cos <bias
  between "calibbias of sin" "$bias_sin" -49 -47
  between "calibbias of cos" "$bias_cos" -49 -47
  expect 0 ada4571-kernel-probe calibration "$URI" shaft >again
  cmp kept again
  between "offset of sin, V" "$(awk '{print $2}' again)" -0.062 0.062
  control 'for c in 0 1; do write 0 $(iio_folder shaft)/in_voltage${c}_calibbias
    write 1 $(iio_folder shaft)/in_voltage${c}_calibscale; done'
}
