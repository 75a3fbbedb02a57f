# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The guest as a machine with a sensor, and words for what checks do to it.

CONFIG=/sys/kernel/config
REPLAY=/sys/bus/platform/devices/ada4571-replay
REPLAY_DRIVER=/sys/bus/platform/drivers/ada4571-replay

# Loads a module: one that was built for the tests, or one of Debian's.
load_module() {
  local name=$1 built
  shift
  for built in "$KERNEL/drivers/$name.ko" "$KERNEL/replay/${name//-/_}.ko"; do
    [[ -e $built ]] || continue
    insmod "$built" "$@"
    return
  done
  modprobe -d "$KERNEL/image" -S "$VERSION" "$name" "$@"
}

set_up_system() {
  local module
  for module in configfs industrialio kfifo_buf industrialio-triggered-buffer \
      industrialio-configfs industrialio-sw-trigger iio-trig-hrtimer irqsim gpio-sim; do
    load_module "$module"
  done
  mount -t configfs configfs "$CONFIG"
  ip link set lo up
  load_module overlay
  mkdir -p /run/ada4571/etc /run/ada4571/etc.work
  mount -t overlay -o lowerdir=/etc,upperdir=/run/ada4571/etc,workdir=/run/ada4571/etc.work \
    overlay /etc
  # Where any user can run them; the checkout may be in a private folder.
  cp -r "$WORK"/programs/{bin,asan} /run/ada4571/
  chmod -R a+rX /run/ada4571/{bin,asan}
  export LD_LIBRARY_PATH=/run/ada4571/bin PATH=/run/ada4571/bin:$PATH
  start_udev
}

start_udev() {
  local udevd
  for udevd in /lib/systemd/systemd-udevd /usr/lib/systemd/systemd-udevd; do
    [[ -x $udevd ]] && break
  done
  cp "$TOP"/udev/60-ada4571.rules /run/udev/rules.d/
  mkdir -p /run/ada4571/udev
  cp "$TOP"/udev/ada4571-permissions /run/ada4571/udev/
  sed -i 's,/usr/lib/udev/ada4571-permissions,/run/ada4571/udev/ada4571-permissions,' \
    /run/udev/rules.d/60-ada4571.rules
  "$udevd" --daemon
}

settle() {
  udevadm settle --timeout=60
}

# load_replay [PARAMETER=VALUE...]: the test device anew.
load_replay() {
  unload_replay
  load_module ada4571-replay "$@"
  settle
}

unload_replay() {
  [[ ! -d /sys/module/ada4571_replay ]] || rmmod ada4571_replay
}

# The IIO device's folder by label.
iio_folder() {
  local folder
  for folder in /sys/bus/iio/devices/iio:device*; do
    [[ $(cat "$folder/label" 2>/dev/null) == "$1" ]] && echo "$folder" && return 0
  done
  fail "no IIO device is labelled $1"
}

unplug() {
  echo "ada4571-replay.${1:-0}" >"$REPLAY_DRIVER/unbind"
}

replug() {
  echo "ada4571-replay.${1:-0}" >"$REPLAY_DRIVER/bind"
  settle
}

# make_trigger NAME HERTZ: an hrtimer trigger; HERTZ again changes its rate.
make_trigger() {
  local folder
  mkdir -p "$CONFIG/iio/triggers/hrtimer/$1"
  for folder in /sys/bus/iio/devices/trigger*; do
    [[ $(cat "$folder/name") == "$1" ]] || continue
    echo "$2" >"$folder/sampling_frequency"
    return 0
  done
  fail "no trigger $1"
}

remove_trigger() {
  rmdir "$CONFIG/iio/triggers/hrtimer/$1"
}

running() {
  local state
  read -r state <"$REPLAY.${1:-0}/running" && [[ $state == 1 ]]
}

# The words of words.sh for this side.
URI=local:
control() {
  eval "$1"
}

# write VALUE FILE
write() {
  echo "$1" >"$2" || fail "cannot write '$1' to $2"
}

# No warning, oops or leak in the kernel's log.
kernel_is_sound() {
  ! dmesg | grep -E 'WARNING|BUG:|Oops|stack-protector|refcount|memory leak'
}

# make_pins: a simulated gpio chip with the sensor's lines and one that nobody names; sets PINS
# (its folder, sim_gpioN/value and so on below) and PINS_CHIP.
make_pins() {
  local config=$CONFIG/gpio-sim/board bank=$CONFIG/gpio-sim/board/bank
  remove_pins
  mkdir -p "$bank"/line{0,1,2}
  write 4 "$bank/num_lines"
  write board "$bank/label"
  write ada4571-gc "$bank/line0/name"
  write ada4571-pd "$bank/line1/name"
  write button "$bank/line2/name"
  write 1 "$config/live"
  settle
  PINS_CHIP=$(cat "$bank/chip_name")
  PINS=/sys/devices/platform/$(cat "$config/dev_name")/$PINS_CHIP
}

remove_pins() {
  local config=$CONFIG/gpio-sim/board
  [[ -d $config ]] || return 0
  write 0 "$config/live"
  rmdir "$config"/bank/line* "$config/bank" "$config"
}

pin_value() {
  cat "$PINS/sim_gpio$1/value"
}
