# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The project's rules under the real systemd-udevd: who may do what.

# as_member COMMAND..., as_outsider COMMAND...: nobody's user, in the group plugdev or not.
MEMBER=(setpriv --reuid 4571 --regid 4571 --groups "$(getent group plugdev | cut -d: -f3)")
as_member() {
  "${MEMBER[@]}" "$@"
}

as_outsider() {
  setpriv --reuid 4572 --regid 4572 --clear-groups "$@"
}

mode_of() {
  stat -L -c '%G %a' "$1"
}

udev_node() {
  local folder file
  folder=$(iio_folder shaft)
  same node "$(mode_of "/dev/$(basename "$folder")")" "plugdev 660"
  for file in buffer/enable buffer/length buffer/watermark scan_elements/in_voltage0_en \
      trigger/current_trigger current_timestamp_clock in_voltage0_calibbias; do
    same "$file" "$(mode_of "$folder/$file")" "plugdev 664"
  done
  # What only looks is left as it was.
  same raw "$(mode_of "$folder/in_voltage0_raw")" "root 644"
}

udev_links() {
  local label
  for label in shaft spare; do
    same "$label" "$(readlink -f "/dev/ada4571/$label")" "/dev/$(basename "$(iio_folder $label)")"
  done
  # The other order: the link follows the label.
  unplug 0
  unplug 1
  settle
  same "links of nothing" "$(ls /dev/ada4571 2>/dev/null)" ""
  replug 1
  replug 0
  for label in shaft spare; do
    same "$label" "$(readlink -f "/dev/ada4571/$label")" "/dev/$(basename "$(iio_folder $label)")"
  done
}

udev_foreign() {
  local folder
  load_replay devices=1 unlabelled=1 labels=bench
  folder=$(iio_folder bench)
  same node "$(mode_of "/dev/$(basename "$folder")")" "root 600"
  same enable "$(mode_of "$folder/buffer/enable")" "root 644"
  load_replay devices=1 unlabelled=1 labels=ada4571-bench
  folder=$(iio_folder ada4571-bench)
  same "node labelled ada4571" "$(mode_of "/dev/$(basename "$folder")")" "plugdev 660"
}

# A converter without labels that a stored configuration of the machine names.
udev_stored() {
  local folder
  mkdir -p /etc/ada4571
  printf '[source]\ndevice = "ada4571-replay"\nsin = "voltage0"\n' >/etc/ada4571/axle.toml
  load_replay devices=1 unlabelled=1 labels=bench
  folder=$(iio_folder bench)
  same node "$(mode_of "/dev/$(basename "$folder")")" "plugdev 660"
  same link "$(readlink -f /dev/ada4571/bench)" "/dev/$(basename "$folder")"
  rm -r /etc/ada4571
}

# The project's own program as a member of the group and as somebody else.
udev_record() {
  make_trigger ada4571-rate 1000
  settle
  chmod 777 .
  expect 0 as_member iio-angle record -d shaft --trigger ada4571-rate --samples 200 -o member.csv
  same rows "$(capture_rows member.csv | wc -l)" 200
  expect 1 as_outsider iio-angle record -d shaft --trigger ada4571-rate --samples 200 \
    -o outsider.csv 2>error
  contains error "udev rules"
  same file "$(ls outsider.csv 2>/dev/null || true)" ""
  echo >"$(iio_folder shaft)/trigger/current_trigger"
  remove_trigger ada4571-rate
}

udev_triggers() {
  local folder
  make_trigger ada4571-rate 1000
  make_trigger other 1000
  settle
  for folder in /sys/bus/iio/devices/trigger*; do
    case $(cat "$folder/name") in
      ada4571-rate) same ada4571-rate "$(mode_of "$folder/sampling_frequency")" "plugdev 664" ;;
      other) same other "$(mode_of "$folder/sampling_frequency")" "root 644" ;;
    esac
  done
  remove_trigger ada4571-rate
  remove_trigger other
}

# A capture by nothing but the kernel's files, as any program would.
capture_as() {
  local folder=$1 file=$2
  shift 2
  "$@" bash -euc '
    cd "$1"
    for element in scan_elements/*_en; do echo 1 >"$element"; done
    echo 64 >buffer/length
    echo 1 >buffer/enable
    head -c 1024 "/dev/$(basename "$1")"
    echo 0 >buffer/enable' capture "$folder" >"$file"
}

udev_capture() {
  local folder
  make_trigger ada4571-rate 1000
  folder=$(iio_folder shaft)
  as_member bash -c "echo ada4571-rate >'$folder/trigger/current_trigger'"
  capture_as "$folder" member as_member
  same "bytes of the member" "$(stat -c %s member)" 1024
  expect 1 capture_as "$folder" outsider as_outsider 2>error
  contains error "Permission denied"
  expect 1 as_outsider head -c 16 "/dev/$(basename "$folder")"
  echo >"$folder/trigger/current_trigger"
  remove_trigger ada4571-rate
}

load_replay devices=2 labels=shaft,spare
check "node and attributes of a sensor belong to the group" udev_node
check "links by label follow the device" udev_links
check "a member of the group captures, an outsider does not" udev_capture
check "a member of the group records with iio-angle, an outsider is told why not" udev_record
check "a device without a sensor stays root's" udev_foreign
check "a device that a stored configuration names is the group's" udev_stored
load_replay devices=2 labels=shaft,spare
check "only triggers of the sensor's name are handed over" udev_triggers
