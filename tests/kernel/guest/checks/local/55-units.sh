# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The units that hold GC and PD from boot on, under the real systemd: it runs as the first process
# of a namespace, with nothing but these two to start.

UNITS=/run/ada4571/units

# start_systemd UNIT...: and these units with it.
start_systemd() {
  local unit systemd=/lib/systemd/systemd
  mkdir -p "$UNITS"
  for unit in gc pd; do
    sed "s,/usr/bin/,/run/ada4571/bin/," "$TOP/udev/ada4571-$unit@.service" \
      >"$UNITS/ada4571-$unit@.service"
    mkdir -p "$UNITS/ada4571-$unit@.service.d"
    # The library lies beside the program here.
    printf '[Service]\nEnvironment=LD_LIBRARY_PATH=/run/ada4571/bin\n' \
      >"$UNITS/ada4571-$unit@.service.d/library.conf"
  done
  for unit in basic sysinit shutdown multi-user; do
    printf '[Unit]\nDefaultDependencies=no\n' >"$UNITS/$unit.target"
  done
  printf 'DefaultDependencies=no\nWants=%s\n' "$*" >>"$UNITS/multi-user.target"
  mkdir -p /sys/fs/cgroup
  mountpoint -q /sys/fs/cgroup || mount -t cgroup2 cgroup2 /sys/fs/cgroup
  SYSTEMD_UNIT_PATH=$UNITS unshare --fork --kill-child --pid --mount-proc \
    "$systemd" --system --unit=multi-user.target --log-target=console --log-level=info \
    >systemd.log 2>&1 &
  SYSTEMD=$!
  wait_for 60 test -S /run/systemd/private || { cat systemd.log; return 1; }
}

# systemctl serves only those of its own namespace.
in_systemd() {
  nsenter -t "$(pgrep -P "$SYSTEMD")" -p -m "$@"
}

unit_is() {
  [[ $(in_systemd systemctl show -p ActiveState --value "$1") == "$2" ]]
}

units_hold() {
  local pid
  mkdir -p /etc/ada4571
  iio-angle list -d shaft --save wheel
  mv "$HOME/.config/ada4571/wheel.toml" /etc/ada4571/
  rm -r "$HOME/.config/ada4571"
  printf 'GC=off\nPD=on\n' >/etc/ada4571/wheel.pins
  write pull-up "$PINS/sim_gpio0/pull"
  start_systemd ada4571-gc@wheel.service ada4571-pd@wheel.service
  # The board pulls the one line up and the other down: the units hold against both.
  wait_for 60 pin_is 1 1 || { cat systemd.log; return 1; }
  wait_for 60 pin_is 0 0 || { cat systemd.log; return 1; }
  unit_is ada4571-gc@wheel.service active
  pid=$(in_systemd systemctl show -p MainPID --value ada4571-pd@wheel.service)
  # No root, and no more than the chip's group.
  between "user of the unit" "$(stat -c %u "/proc/$(pgrep -f 'pins pd on')")" 61184 65519
  expect 1 iio-angle pins pd off 2>error
  contains error "in use"
  # What died comes again.
  pkill -9 -f 'pins pd on'
  wait_for 5 pin_is 1 0
  wait_for 60 pin_is 1 1
  [[ $(in_systemd systemctl show -p MainPID --value ada4571-pd@wheel.service) != "$pid" ]]
  in_systemd systemctl stop ada4571-pd@wheel.service
  unit_is ada4571-pd@wheel.service inactive
  pin_is 1 0
  kill -9 "$SYSTEMD"
  write pull-down "$PINS/sim_gpio0/pull"
  rm -r /etc/ada4571
}

check "systemd holds GC and PD from boot on, as no root, and again when they die" units_hold
