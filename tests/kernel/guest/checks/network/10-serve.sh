# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The guest as a server: the real iiod, and command lines from the other side, one at a time, until
# it says stop.

start_iiod() {
  /usr/sbin/iiod >"$OUT/iiod.log" 2>&1 &
  IIOD=$!
}

# On its end it would wait for avahi, half a minute.
stop_iiod() {
  [[ -n ${IIOD:-} ]] || return 0
  kill -9 "$IIOD"
  wait "$IIOD" 2>/dev/null || true
}

iiod_answers() {
  iio_info -u ip:127.0.0.1 >/dev/null 2>&1
}

restart_iiod() {
  stop_iiod
  start_iiod
  wait_for 10 iiod_answers
}

serve() {
  local id=0 line
  touch "$OUT/ready"
  while :; do
    id=$((id + 1))
    until [[ -e $OUT/command.$id ]]; do pause 0.05; done
    line=$(<"$OUT/command.$id")
    [[ $line != stop ]] || break
    # In this shell: what a command starts is still known to the next one.
    eval "$line" >"$OUT/output.$id" 2>&1
    echo $? >"$OUT/status.tmp"
    mv "$OUT/status.tmp" "$OUT/status.$id"
  done
}

load_module virtio_net
ip addr add 10.0.2.15/24 dev eth0
ip link set eth0 up
load_replay devices=1 labels=shaft
restart_iiod
serve
kernel_is_sound >"$OUT/sound" 2>&1 && touch "$OUT/is-sound"
