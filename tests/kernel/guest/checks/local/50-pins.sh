# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# GC and PD on a simulated chip, seen from the program's side and from the board's.

# hold PIN STATE OPTION...: iio-angle in the background until it says that it holds the line; sets
# HOLDER. release ends it.
hold() {
  iio-angle pins "$1" "$2" --hold "${@:3}" 2>held &
  HOLDER=$!
  wait_for 5 grep -q Ctrl-C held || { cat held; return 1; }
}

release() {
  kill -TERM "$HOLDER"
  ended "$HOLDER" 5
}

pins_by_name() {
  hold gc on
  same "gc pd" "$(pin_value 0) $(pin_value 1)" "1 0"
  release
  hold pd on
  same "gc pd" "$(pin_value 0) $(pin_value 1)" "0 1"
  release
  # Off against a board that pulls up.
  write pull-up "$PINS/sim_gpio0/pull"
  hold gc off
  same gc "$(pin_value 0)" 0
  release
  write pull-down "$PINS/sim_gpio0/pull"
}

pin_is() {
  [[ $(pin_value "$1") == "$2" ]]
}

pins_by_offset() {
  hold gc on --line "$PINS_CHIP:3"
  same level "$(pin_value 3)" 1
  same "the line of the default name" "$(pin_value 0)" 0
  release
}

pins_active_low() {
  hold pd off --active-low
  same level "$(pin_value 1)" 1
  release
}

# The board pulls the line; the program tells what it is, and does not drive it.
pins_read() {
  write pull-up "$PINS/sim_gpio0/pull"
  same "pulled up" "$(iio-angle pins gc)" on
  write pull-down "$PINS/sim_gpio0/pull"
  same "pulled down" "$(iio-angle pins gc)" off
  same "pulled down, active low" "$(iio-angle pins gc --active-low)" on
}

# Both lines by one handle; they stay while it lives, and fall back when it is killed.
pins_held() {
  local holder
  mkfifo say
  ada4571-kernel-probe pins <say >out &
  holder=$!
  exec 6>say
  echo "gc on" >&6
  echo "pd on" >&6
  wait_for 5 grep -q "pd on" out
  same "gc pd" "$(pin_value 0) $(pin_value 1)" "1 1"
  pause 1
  same "gc pd later" "$(pin_value 0) $(pin_value 1)" "1 1"
  kill -9 $holder
  wait $holder || true
  exec 6>&-
  # What a line does then is its driver's affair; the simulated one lets go.
  wait_for 5 pin_is 0 0
}

pins_power_up() {
  printf 'pd on\npd off\n' | ada4571-kernel-probe pins >out
  between "wait for the sensor, s" "$(sed -n 's/pd off after \(.*\) s/\1/p' out)" 0.01 0.1
  between "no wait to switch off, s" "$(sed -n 's/pd on after \(.*\) s/\1/p' out)" 0 0.01
}

pins_busy() {
  hold gc on
  expect 1 iio-angle pins gc off 2>error
  one_line error
  contains error "in use"
  same "the holder's level" "$(pin_value 0)" 1
  release
}

pins_missing() {
  expect 1 iio-angle pins gc on --line no-such-line 2>error
  one_line error
  contains error no-such-line
  expect 1 iio-angle pins gc on --line "$PINS_CHIP:77" 2>error
  one_line error
}

pins_permission() {
  same chip "$(mode_of "/dev/$PINS_CHIP")" "plugdev 660"
  expect 1 as_outsider iio-angle pins gc on 2>error
  one_line error
  contains error "permission"
  "${MEMBER[@]}" iio-angle pins gc on --hold 2>held &
  HOLDER=$!
  wait_for 5 grep -q Ctrl-C held
  same level "$(pin_value 0)" 1
  release
}

# A stored configuration names the lines, and a recording says what GC was.
pins_stored() {
  local level
  iio-angle list -d shaft --save wheel
  cat >>"$HOME/.config/ada4571/wheel.toml" <<END

[pins]
gc = "$PINS_CHIP:2"
gc_active_low = true
END
  write 1 "$REPLAY.0/untriggered"
  for level in up down; do
    write pull-$level "$PINS/sim_gpio2/pull"
    start_capture out iio-angle record -s wheel --samples 64 -o $level.csv
    push "64 100000 wait"
    ended "$CAPTURE" 20
  done
  contains up.csv "# gain_control = off"
  contains down.csv "# gain_control = on"
  hold gc off -s wheel
  same level "$(pin_value 2)" 1
  release
  rm -r "$HOME/.config/ada4571"
}

load_replay devices=1 labels=shaft
make_pins
check "pins drives GC and PD by their names, as the board sees it" pins_by_name
check "pins drives a line by chip and offset" pins_by_offset
check "an active-low line is inverted" pins_active_low
check "pins tells what the board does to a line" pins_read
check "lines are held as long as the handle lives" pins_held
check "power-up waits for the sensor" pins_power_up
check "a busy line is one clear sentence, and stays as it was" pins_busy
check "a missing line is one clear sentence" pins_missing
check "the group may set pins, others are told why not" pins_permission
check "a stored configuration names the pins, and a recording says what GC was" pins_stored
