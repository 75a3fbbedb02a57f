# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The test device itself, by the kernel's own files: what the other checks stand on.

# start_node LABEL LENGTH: all channels into a buffer of that many frames.
start_node() {
  local folder element
  folder=$(iio_folder "$1")
  write 0 "$folder/buffer/enable"
  for element in "$folder"/scan_elements/*_en; do write 1 "$element"; done
  write "$2" "$folder/buffer/length"
  write 1 "$folder/buffer/enable"
}

stop_node() {
  write 0 "$(iio_folder "$1")/buffer/enable"
}

# read_node LABEL BYTES FILE
read_node() {
  timeout 5 head -c "$2" "/dev/$(basename "$(iio_folder "$1")")" >"$3"
}

device_names() {
  local folder
  folder=$(iio_folder shaft)
  same name "$(cat "$folder/name")" ada4571-replay
  same labels "$(cat "$folder"/in_voltage{0,1,2,3}_label | xargs)" "vsin vcos vtemp vdd"
  iio_folder spare
}

device_attributes() {
  local folder
  folder=$(iio_folder shaft)
  frames table le:u12/16 8 >table
  cat table >"$REPLAY.0/table"
  same raw "$(cat "$folder"/in_voltage{0,1,2,3}_raw | xargs)" "$(frames codes table | head -1)"
  same scale "$(cat "$folder/in_voltage0_scale") $(cat "$folder/in_voltage3_scale")" \
    "1.220703125 2.441406250"
  write -7 "$folder/in_voltage1_offset"
  same offset "$(cat "$folder/in_voltage1_offset")" -7
  write 0 "$folder/in_voltage1_offset"
}

device_calibration() {
  local folder
  folder=$(iio_folder shaft)
  frames turn 8 10 >table
  cat table >"$REPLAY.0/table"
  write -48 "$folder/in_voltage1_calibbias"
  write 0.5 "$folder/in_voltage1_calibscale"
  # Row 0: vcos is 3235.
  same raw "$(cat "$folder/in_voltage1_raw")" $((3235 / 2 - 48))
  expect 1 write 40000 "$folder/in_voltage1_calibbias"
  write 0 "$folder/in_voltage1_calibbias"
  write 1 "$folder/in_voltage1_calibscale"
  same raw "$(cat "$folder/in_voltage1_raw")" 3235
}

device_error() {
  local folder
  folder=$(iio_folder shaft)
  write 5 "$REPLAY.0/error"
  expect 1 cat "$folder/in_voltage0_raw" 2>error
  contains error "Input/output error"
  write 0 "$REPLAY.0/error"
  cat "$folder/in_voltage0_raw"
}

# One format, in the node's bytes, with exact time stamps and with rubbish in the unused bits.
device_format() {
  local format=$1 bytes first
  write 1 "$REPLAY.0/untriggered"
  write "$format" "$REPLAY.0/format"
  write 0xa5a5a5a5a5a5a5a5 "$REPLAY.0/padding"
  frames table "$format" 64 >table
  cat table >"$REPLAY.0/table"
  bytes=$(($(frames scan table "$format" 0 0 | wc -c) / 64))
  start_node shaft 64
  write "64 100000" "$REPLAY.0/push"
  read_node shaft $((64 * bytes)) got
  stop_node shaft
  same stats "$(cat "$REPLAY.0/stats")" "64 0"
  first=$(tail -c +$((bytes - 7)) got | head -c 8 | od -An -td8 | tr -d ' ')
  frames scan table "$format" "$first" 100000 0xa5a5a5a5a5a5a5a5 >expected
  cmp got expected
}

device_overrun() {
  local pushed dropped
  write 1 "$REPLAY.0/untriggered"
  frames turn 4000 1 >table
  cat table >"$REPLAY.0/table"
  start_node shaft 128
  write "1000 100000" "$REPLAY.0/push"
  read -r pushed dropped <"$REPLAY.0/stats"
  read_node shaft $((pushed * 16)) got
  stop_node shaft
  same "pushed and dropped" $((pushed + dropped)) 1000
  same "frames that the buffer keeps" "$pushed" 128
  # vtemp counts the rows.
  od -An -v -w16 -tu2 got | awk '{print $3}' >rows
  seq 0 127 | cmp rows
}

device_clock() {
  write 1 "$REPLAY.0/untriggered"
  start_node shaft 30
  write "10 100000" "$REPLAY.0/push"
  write 5000000 "$REPLAY.0/step"
  write "10 100000" "$REPLAY.0/push"
  write 3 "$REPLAY.0/lose"
  write "13 100000" "$REPLAY.0/push"
  read_node shaft $((30 * 16)) got
  stop_node shaft
  frames times got 16 | awk 'NR > 1 {print $1 - last} {last = $1}' >differences
  same differences "$(sort differences | uniq -c | xargs)" "27 100000 1 400000 1 5100000"
  same stats "$(cat "$REPLAY.0/stats")" "30 3"
}

device_needs_trigger() {
  local folder
  write 0 "$REPLAY.0/untriggered"
  folder=$(iio_folder shaft)
  echo 1 >"$folder/scan_elements/in_voltage0_en"
  expect 1 write 1 "$folder/buffer/enable"
  write 0 "$folder/scan_elements/in_voltage0_en"
}

device_survives() {
  local i reader
  make_trigger busy 2000
  for i in 1 2 3 4 5 6; do
    load_replay devices=2
    write busy "$(iio_folder replay0)/trigger/current_trigger"
    start_node replay0 4096
    cat "/dev/$(basename "$(iio_folder replay0)")" >got &
    reader=$!
    wait_for 5 test -s got
    if ((i % 2)); then
      unplug
      wait_for 5 test ! -d "$REPLAY.0/driver"
    else
      # A trigger is attached: the module is in use, as any driver's.
      expect 1 rmmod ada4571_replay
      stop_node replay0
    fi
    kill "$reader" 2>/dev/null || true # 6.12 has ended it with ENODEV
    wait "$reader" || true
    unload_replay
  done
  remove_trigger busy
  kernel_is_sound
}

load_replay devices=2 labels=shaft,spare
check "the test device is there with labelled channels" device_names
check "raw, scale and offset read what was set" device_attributes
check "calibbias and calibscale act on the codes and refuse what is out of range" device_calibration
check "a read of raw fails with the errno that was asked for" device_error
for format in le:u12/16'>>'4 be:u12/16'>>'4 le:s16/16 be:s16/16 le:u24/32 be:s24/32'>>'8 \
    "le:u32/32 le:u16/16 be:s12/16>>4 be:u24/32>>8"; do
  check "the node delivers ${format// /, } bit for bit" device_format "$format"
done
write le:u12/16 "$REPLAY.0/format"
write 0 "$REPLAY.0/padding"
check "an overrun keeps the oldest frames and is counted" device_overrun
check "a step in the clock and lost frames stand in the time stamps" device_clock
check "the device wants a trigger as any other" device_needs_trigger
check "unbind while a capture runs, and load and unload, leave the kernel sound" device_survives
