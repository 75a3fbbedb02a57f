# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# What must hold when everything has run.

udev_nothing_for_all() {
  settle
  make_trigger ada4571-rate 1000
  settle
  find -L /dev/ada4571 /dev/iio:device* /dev/gpiochip* -maxdepth 1 -type c >nodes
  find /sys/devices/platform/ada4571-replay.* "$PINS" /sys/bus/iio/devices/trigger*/ -type f >files
  remove_trigger ada4571-rate
  # Two devices, two links to them and a chip, and their attributes.
  between "nodes" "$(wc -l <nodes)" 5 9
  between "attributes" "$(wc -l <files)" 50 1000
  same "nodes open to all" "$(xargs -a nodes stat -L -c '%A %n' | grep -v '^c......---' || true)" ""
  same "attributes open to all" "$(xargs -a files stat -c '%A %n' | grep '^........w' || true)" ""
}

load_replay devices=2 labels=shaft,spare
make_pins
check "nothing that the rules touch is open to all" udev_nothing_for_all
check "the kernel's log has no warning" kernel_is_sound
