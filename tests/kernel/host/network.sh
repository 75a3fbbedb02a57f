# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Checks from this side: libiio's network backend against the real iiod in the guest.

# The words of words.sh for this side.
REPLAY=/sys/bus/platform/devices/ada4571-replay
control() {
  in_guest "$@"
}

network_checks() {
  if ! await ready 120; then
    number_line "not ok - the network guest is ready"
    return 0
  fi
  URI=ip:127.0.0.1:$PORT
  SCRATCH=$WORK/scratch
  mkdir -p "$SCRATCH"
  # In a subshell: check() counts on a shell that goes on after a failure.
  (
    set +e
    report() { number_line "$1"; }
    local file
    for file in "$HERE"/checks.sh "$HERE"/words.sh "$HERE"/host/checks/*.sh; do
      # shellcheck source=/dev/null
      . "$file"
    done
  )
  send_command stop
  wait_for_end 60 || true
  if [[ -e $OUT/is-sound ]]; then
    number_line "ok - network: the kernel's log has no warning"
  else
    number_line "not ok - network: the kernel's log has no warning"
    sed 's/^/#   /' "$OUT/sound" 2>/dev/null | head -5
  fi
}

wait_for_end() {
  local deadline=$((SECONDS + $1))
  while guest_alive && ((SECONDS < deadline)); do sleep 0.2; done
}
