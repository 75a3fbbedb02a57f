# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The same over the network, and what only a network does.

# shellcheck source=/dev/null
. "$HERE/captures.sh"

network_list() {
  expect 0 iio-angle list -u "$URI" >out
  contains out ada4571-replay
  contains out "voltage0 (vsin)"
  contains out "voltage1 (vcos)"
}

network_nobody() {
  expect 1 iio-angle list -u "ip:127.0.0.1:$(free_port)" 2>error
  one_line error
}

# The server dies during a capture and comes back.
network_server_lost() {
  frames turn 640 1 >table
  use_table table
  mkfifo go
  ada4571-kernel-probe replug "$URI" shaft 640 >out 2>error <go &
  CAPTURE=$!
  exec 5>go
  control "wait_for 20 running"
  push "640 100000 wait"
  wait_for 20 grep -q before out
  control stop_iiod
  wait_for 30 grep -q ended out || fail "the capture goes on without a server: $(cat out error)"
  contains out "ended ADA4571_ERROR_DISCONNECTED"
  control restart_iiod
  echo go >&5
  exec 5>&-
  control "wait_for 20 running"
  push "640 100000 wait"
  ended "$CAPTURE" 30 || { cat out error; return 1; }
  contains out "again 640"
}

# network_rate HERTZ: no frame is lost between the driver and the file. The guest's clock may skip
# ticks when this machine is busy; the table's own numbers tell what the driver delivered.
network_rate() {
  local count=10000
  frames turn 4096 1 >table
  use_table table
  control "write 0 $REPLAY.0/untriggered; make_trigger ada4571-rate $1; settle"
  # The server's context is from before the trigger.
  control restart_iiod
  expect 0 iio-angle record -u "$URI" -d shaft --trigger ada4571-rate --samples $count \
    -o capture.csv 2>error
  same rows "$(capture_rows capture.csv | wc -l)" $count
  frames from capture.csv 1.25 >codes
  frames codes codes | awk 'NR > 1 && $3 != (last + 1) % 4096 {print "row " NR; bad = 1}
    {last = $3} END {exit bad}'
  control 'echo >"$(iio_folder shaft)/trigger/current_trigger"; remove_trigger ada4571-rate'
}

check "network: iio-angle list finds the device by its labels" network_list
check "network: a server that is not there is one clear sentence" network_nobody
for format in le:u12/16'>>'4 be:s16/16 "le:u24/32 le:u16/16 be:s12/16>>4 be:u24/32>>8"; do
  check "network: decodes ${format// /, } bit for bit" capture_format "$format"
done
check "network: record writes the codes and times that were injected" capture_record
check "network: record, calibrate, convert and live read agree" capture_job
check "network: a SigMF capture gives the same angles as text" capture_sigmf
check "network: lost frames are counted exactly" capture_losses
check "network: a time-out is no end, and loses nothing" capture_timeout
check "network: cancel ends a read at once" capture_cancel
check "network: calibration goes into calibbias and comes back" capture_calibbias
check "network: unplug ends the capture, replug and start go on" capture_replug
check "network: a lost server ends the capture, start goes on when it is back" network_server_lost
for hertz in 1000 5000; do
  check "network: 10,000 frames at $hertz S/s, none lost on the way" network_rate $hertz
done
