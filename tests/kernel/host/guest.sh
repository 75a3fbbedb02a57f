# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Starting, watching and ending the guest.

# A port of the loopback that nobody listens on.
free_port() {
  local port
  while :; do
    port=$((20000 + RANDOM % 12000))
    (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || break
  done
  echo "$port"
}

# What the guest's script has to know; read there as shell.
write_settings() {
  local name
  for name in PHASE HERE TOP WORK KERNEL VERSION ASAN_BUILD ONLY; do
    printf '%s=%q\n' "$name" "${!name}"
  done >"$OUT/settings"
}

# stage BUILD FOLDER: the programs and the library, without the debug information that would fill
# the guest's memory. Each from its own place: another test may be writing a program of that name
# elsewhere in the build just now.
stage() {
  local file
  mkdir -p "$WORK/programs/$2"
  [[ -n $1 ]] || return 0
  for file in tools/iio-angle tests/kernel/ada4571-kernel-probe lib/libada4571.so.1; do
    file=$1/$file
    [[ ! -e $file ]] || strip -g -o "$WORK/programs/$2/$(basename "$file")" "$file"
  done
}

# A recording of the simulated sensor for the guest, where the mathematics would be slow. Absent
# when the build has no iio-angle; the check that wants it then fails.
simulate_recording() {
  iio-angle simulate --seed 4571 --duration 0.5 -o "$WORK/simulated.csv" \
    >"$WORK/simulate.log" 2>&1 || return 0
  perl "$HERE/frames.pl" grid "$WORK/simulated.csv" 0.125 5000 >"$OUT/simulated.csv"
}

# boot PHASE SLEEP: PHASE is the list of checks, SLEEP how virtual time passes when idle.
boot() {
  PHASE=$1
  OUT=$WORK/$PHASE
  PORT=$(free_port)
  mkdir -p "$OUT"
  : >"$OUT/results"
  write_settings
  [[ $PHASE != local ]] || simulate_recording
  timeout -k 5 "$TIMEOUT" qemu-system-x86_64 -M pc -cpu qemu64 -accel tcg,thread=single \
    -icount "shift=2,$2" -m 768 -display none -no-reboot -nodefaults \
    -serial "file:$OUT/console" -kernel "$KERNEL/vmlinux" -initrd "$KERNEL/initramfs.cpio" \
    -append "console=ttyS0 quiet panic=-1 net.ifnames=0 ada4571.main=$HERE/guest/main" \
    -virtfs "local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap" \
    -virtfs "local,path=$OUT,mount_tag=out,security_model=none" \
    -netdev "user,id=n0,restrict=on,hostfwd=tcp:127.0.0.1:$PORT-10.0.2.15:30431" \
    -device virtio-net-pci,netdev=n0,romfile= </dev/null >"$OUT/qemu.log" 2>&1 9>&- &
  QEMU_PID=$!
}

guest_alive() {
  kill -0 "$QEMU_PID" 2>/dev/null
}

# Waits for a file that the guest writes.
await() {
  local file=$OUT/$1 deadline=$((SECONDS + ${2:-60}))
  while [[ ! -e $file ]]; do
    guest_alive && ((SECONDS < deadline)) || return 1
    sleep 0.05
  done
}

# Commands are numbered by files, since checks run in subshells.
send_command() {
  COMMAND=1
  while [[ -e $OUT/command.$COMMAND ]]; do COMMAND=$((COMMAND + 1)); done
  printf '%s\n' "$*" >"$OUT/command.tmp"
  mv "$OUT/command.tmp" "$OUT/command.$COMMAND"
}

# Runs a command line in the guest, prints what it printed, returns its status.
in_guest() {
  local COMMAND
  send_command "$@"
  await "status.$COMMAND" 60 || { echo "the guest does not answer" && return 1; }
  cat "$OUT/output.$COMMAND"
  return "$(cat "$OUT/status.$COMMAND")"
}

# Prints the guest's results as they come, until it has powered off.
follow() {
  local shown=0 total
  while :; do
    local alive=1
    guest_alive || alive=''
    total=$(wc -l <"$OUT/results")
    if ((total > shown)); then
      sed -n "$((shown + 1)),${total}p" "$OUT/results" | while IFS= read -r line; do
        number_line "$line"
      done
      shown=$total
    fi
    [[ -n $alive ]] || break
    sleep 0.2
  done
  QEMU_PID=''
  if [[ ! -e $OUT/finished ]]; then
    number_line "not ok - the $PHASE guest came to its end"
    tail -n 15 "$OUT/console" "$OUT/qemu.log" 2>/dev/null | sed 's/^/#   /'
  fi
}
