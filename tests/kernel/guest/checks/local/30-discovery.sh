# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Which device, which channels.

list_by_label() {
  load_replay devices=1 labels=shaft
  expect 0 iio-angle list >out
  contains out ada4571-replay
  contains out shaft
  contains out "voltage0 (vsin)"
  contains out "voltage1 (vcos)"
}

list_two() {
  load_replay devices=2 labels=shaft,spare
  expect 0 iio-angle list >out
  same devices "$(grep -c ada4571-replay out)" 2
  # Which of the two is not for the program to guess.
  expect 2 iio-angle record --samples 10 -o two.csv 2>error
  one_line error
  contains error iio:device0
  contains error iio:device1
  same file "$(ls two.csv 2>/dev/null || true)" ""
}

list_unlabelled() {
  load_replay devices=1 unlabelled=1 labels=bench
  expect 0 iio-angle list >out
  contains out "--sin"
  expect 1 iio-angle record --samples 10 -o none.csv 2>error
  one_line error
  write 1 "$REPLAY.0/untriggered"
  start_capture out iio-angle record --sin voltage1 --cos voltage0 --samples 16 -o swapped.csv
  push "64 100000"
  ended "$CAPTURE" 20
  # vsin is what the table calls vcos: 2048 + 1187 codes of 5 V / 4096 at the start.
  between "first vsin" "$(column swapped.csv vsin_v | head -1)" 3.9488 3.9492
}

list_nothing() {
  unload_replay
  expect 1 iio-angle list 2>error
  one_line error
}

stored_name() {
  load_replay devices=2 labels=shaft,spare
  expect 0 iio-angle list -d spare --save wheel
  contains "$HOME/.config/ada4571/wheel.toml" spare
  write 1 "$REPLAY.1/untriggered"
  iio-angle record -s wheel --samples 8 -o own.csv &
  CAPTURE=$!
  wait_for 20 running 1
  write "64 100000" "$REPLAY.1/push"
  ended "$CAPTURE" 20
  same rows "$(capture_rows own.csv | wc -l)" 8
  # The machine's own folder comes after the user's.
  mkdir -p /etc/ada4571
  sed s/spare/shaft/ "$HOME/.config/ada4571/wheel.toml" >/etc/ada4571/axle.toml
  write 1 "$REPLAY.0/untriggered"
  start_capture out iio-angle record -s axle --samples 8 -o system.csv
  push "64 100000"
  ended "$CAPTURE" 20
  same rows "$(capture_rows system.csv | wc -l)" 8
  rm -r "$HOME/.config/ada4571" /etc/ada4571
}

check "iio-angle list finds the device by the labels of its channels" list_by_label
check "two devices are listed, and a choice is asked for" list_two
check "channels without labels are named by options" list_unlabelled
check "a machine without a sensor is told so in one line" list_nothing
check "a stored name opens the device, from the user's folder and from /etc/ada4571" stored_name
