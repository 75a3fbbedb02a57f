#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# watch.sh BUILD [PATTERN]: the live picture in terminals that tmux emulates: what the user sees is
# compared, and keys are pressed.
set -u
BUILD=$(cd "$1" && pwd)
PATH=$BUILD/tools:$PATH
export LC_ALL=C.UTF-8
unset NO_COLOR
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"

mux() {
  tmux -L "$SOCKET" -f /dev/null "$@"
}

# terminal COLUMNS ROWS COMMAND: in a terminal of that size; its exit status goes to `status`.
terminal() {
  # A server of its own for each: one that is ending would take the next session with it.
  TERMINALS=$((${TERMINALS:-0} + 1))
  SOCKET=watch$BASHPID-$TERMINALS
  trap 'mux kill-server 2>/dev/null; stop_emulator' EXIT
  mux new-session -d -x "$1" -y "$2" "$3; echo \$? >status; sleep 60"
}

screen() {
  mux capture-pane -p "$@"
}

# shows PATTERN...: waits up to 20 s until the screen has all of them.
shows() {
  local i pattern missing
  for ((i = 0; i < 200; i++)); do
    missing=
    screen >shot
    for pattern; do
      grep -qE -- "$pattern" shot || missing=$pattern
    done
    [[ -n $missing ]] || return 0
    sleep 0.1
  done
  fail "the screen has no '$missing': $(cat shot)"
}

# gone PATTERN: waits up to 20 s until the screen no longer has it; one that is taken while it is drawn
# has the old and the new.
gone() {
  local i
  for ((i = 0; i < 200; i++)); do
    screen >shot
    grep -qE -- "$1" shot || return 0
    sleep 0.1
  done
  fail "the screen still has '$1': $(cat shot)"
}

ended() {
  local i
  for ((i = 0; i < 200; i++)); do
    [[ ! -s status ]] || break
    sleep 0.1
  done
  same "exit status" "$(cat status)" "$1"
}

simulate() {
  iio-angle simulate --seed 4571 --duration 20 --motion constant:rpm=2 -o a.csv 2>err ||
    fail "$(cat err)"
  iio-angle calibrate single a.csv -o a.toml 2>err || fail "$(cat err)"
}

WATCH="iio-angle watch --capture a.csv --calibration a.toml"

check_everything_is_there_at_80x14_and_at_200x60() {
  simulate
  for size in "80 14" "80 24" "200 60"; do
    rm -f status
    # shellcheck disable=SC2086 # columns and rows
    terminal $size "$WATCH"
    shows '^recording of simulation' 'angle +[0-9.]+ deg' 'radius (1\.0|0\.9)' 'rpm' ' ok' \
      'known within 180 deg: the shaft is at [0-9.]+ or [0-9.]+ *$' '^ +90 ' '^180' '270 deg' \
      'angle, deg' 'radius \(1: as calibrated\)' '-10 s .*-5 s .*now' '[0-9]+ samples$' 'lost 0  unsound 0' \
      ' 10000 Hz  noise 0\.[0-9]+ deg' '\(~2[0-9] C\)' 'q quit +space hold +z zero' \
      '(⣀|⠉|⠤|⣿|⠒)(⣀|⠉|⠤|⣿|⠒)'
    same "rows" "$(wc -l <shot)" "${size#* }"
    mux send-keys q
    ended 0
    mux kill-server
  done
}

check_less_room_is_refused_in_a_sentence() {
  simulate
  terminal 79 14 "$WATCH"
  ended 1
  shows '^iio-angle: the terminal has 79x14 characters, watch needs 80x14'
}

check_a_resized_terminal_is_drawn_anew() {
  simulate
  terminal 80 24 "$WATCH"
  shows 'q quit'
  mux resize-window -x 120 -y 40
  # Until the new picture is drawn, the old one is there, of 80 columns.
  shows 'q quit' '^.{100,}now$'
  same "last line" "$(tail -1 shot | cut -c1-6)" 'q quit'
  same "keys" "$(grep -c 'q quit' shot)" 1
  mux resize-window -x 60 -y 10
  shows 'too small: make it 80x14'
  mux resize-window -x 80 -y 14
  shows 'angle, deg' 'q quit'
  mux send-keys q
  ended 0
}

check_the_keys_hold_zero_and_quit() {
  simulate
  terminal 80 24 "$WATCH"
  shows 'angle +[0-9]'
  mux send-keys Space
  shows 'HELD'
  local held
  held=$(grep -oE 'angle +[0-9.]+ deg' shot)
  sleep 0.5
  shows 'HELD'
  same "held angle" "$(grep -oE 'angle +[0-9.]+ deg' shot)" "$held"
  mux send-keys z
  shows 'angle +0\.000 deg' "zero at ${held//[!0-9.]/} deg"
  mux send-keys a
  local i
  for ((i = 0; i < 100; i++)); do # the picture may be half drawn
    screen >shot
    grep -q 'zero at' shot || break
    sleep 0.1
  done
  ! grep -q 'zero at' shot || fail "the zero is still there"
  shows "$held"
  mux send-keys Space
  shows 'angle +[0-9]'
  for ((i = 0; i < 100; i++)); do
    screen >shot
    grep -q 'HELD' shot || break
    sleep 0.1
  done
  ! grep -q "$held" shot || fail "the angle stands still"
  mux send-keys q
  ended 0
}

check_the_screen_is_given_back() {
  simulate
  terminal 80 24 "echo before; $WATCH"
  shows 'q quit'
  mux send-keys q
  ended 0
  shows '^before$'
  ! grep -q 'q quit' shot || fail "the picture is still there"
}

check_a_recording_stays_at_its_end_and_ctrl_c_ends() {
  simulate
  terminal 80 24 "$WATCH --speed 50"
  shows 'END of the recording' 'lost 0'
  mux send-keys C-c
  ended 0
}

# What is pending for a stopped thread is delivered when it goes on, the last one first: the terminating
# signal, then the interrupt, before the program can end in good order.
check_a_second_ctrl_c_gives_the_terminal_back() {
  simulate
  # The shell becomes the program: its number is known however a foreign program is started.
  terminal 80 24 "stty -a | grep -oE -- '-?(icanon|echo)\\b' >modes; sh -c 'echo \$\$ >pid; exec $WATCH'; stty -a | grep -oE -- '-?(icanon|echo)\\b' >after"
  shows 'q quit'
  /usr/bin/python3 - "$(cat pid)" <<'EOS' || fail "no such thread"
import ctypes, os, signal, sys
pid = int(sys.argv[1])
libc = ctypes.CDLL(None, use_errno=True)
os.kill(pid, signal.SIGSTOP)
for number in (signal.SIGINT, signal.SIGTERM):
    if libc.tgkill(pid, pid, int(number)) != 0:
        sys.exit(os.strerror(ctypes.get_errno()))
os.kill(pid, signal.SIGCONT)
EOS
  local i
  for ((i = 0; i < 200; i++)); do
    [[ ! -s after ]] || break
    sleep 0.1
  done
  same "modes" "$(cat after)" "$(cat modes)"
  same "alternate screen, cursor" "$(mux display -p '#{alternate_on} #{cursor_flag}')" '0 1'
}

check_a_terminal_that_cannot_be_drawn_on_gets_lines() {
  simulate
  local kind
  for kind in dumb '' no-such-terminal; do
    terminal 80 14 "TERM='$kind' $WATCH --speed 0.01"
    shows "^ +[0-9.]+ s +[0-9.]+ deg +radius"
    mux capture-pane -p -S - >whole
    case $kind in
    '') says whole '^TERM is not set: printing lines instead of the picture$' ;;
    *) says whole "^a terminal of type '$kind' cannot show the picture: printing lines\$" ;;
    esac
    mux kill-server
  done
  # Lines need no room, and a pipe is told nothing of terminals.
  terminal 40 8 "TERM=dumb $WATCH --speed 1000 2>err | head -3 >piped"
  ended 0
  same "lines" "$(wc -l <piped)" 3
  ! grep -q 'picture' err || fail "$(cat err)"
}

check_colours_and_no_color() {
  simulate
  local escape=$'\e'
  terminal 80 24 "TERM=screen-256color $WATCH"
  shows ' ok'
  screen -e >coloured
  grep -qE "$escape\[[0-9;]*3[0-9]m" coloured || fail "no colour"
  mux kill-server
  terminal 80 24 "NO_COLOR=1 TERM=screen-256color $WATCH"
  shows ' ok'
  screen -e >plain
  ! grep -qE "$escape\[([0-9;]*;)?3[0-7]m" plain || fail "colour in spite of NO_COLOR"
}

check_without_utf_8_it_is_ascii() {
  simulate
  terminal 80 24 "LC_ALL=C $WATCH"
  shows 'angle, deg' 'q quit' "^180.*[.:']"
  ! LC_ALL=C grep -q '[^ -~]' shot || fail "$(LC_ALL=C grep '[^ -~]' shot)"
}

check_losses_and_returns_are_told_in_the_picture() {
  emulate --temperature constant:deg_c=25
  local port=${URI##*:}
  terminal 80 24 "iio-angle watch -u $URI"
  shows 'angle +[0-9.]+ deg' 'no calibration|lost 0'
  stop_emulator
  shows 'AWAY: trying again every second' '^q quit'
  rm uri
  emulate --temperature constant:deg_c=25 --port "$port"
  shows 'back after [0-9.]+ s' 'lost [1-9]'
  gone AWAY
  mux send-keys q
  ended 0
}

check_a_sensor_of_one_period_leaves_nothing_open() {
  simulate
  sed -i 's/^# periods_per_turn = 2/# periods_per_turn = 1/' a.csv
  terminal 80 24 "iio-angle watch --capture a.csv"
  shows 'within a turn: nothing is left open'
}

command -v tmux >/dev/null || { echo "tmux is missing"; exit 1; }
# A capture is read as a whole before its first angle; who waits for that sees what for.
check_what_is_read_is_said_where_it_takes_long() {
  status 0 iio-angle simulate --seed 4571 --duration 1 -o a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  mkfifo pipe
  local verb
  for verb in "read --calibration a.toml" "watch --calibration a.toml" emulate; do
    terminal 80 24 "iio-angle $verb --capture pipe"
    (exec 3>pipe && sleep 4 && cat a.csv >&3) &
    shows 'reading pipe, [1-9] s'
    case $verb in
    read*) shows '^ +0\.[0-9]{3} s .* deg' ;;
    watch*) shows 'deg' ;;
    *) shows '^ip:127\.0\.0\.1:' ;;
    esac
    gone 'reading pipe'
    mux kill-server
    wait
  done
}

run_checks "${2:-}"
