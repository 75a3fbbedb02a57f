# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Captures paced by a trigger, in exact time.

# rate HERTZ: frames by an hrtimer trigger, counted by the table's own numbers.
capture_rate() {
  local count=10000
  frames turn 4096 1 >table
  use_table table
  write 0 "$REPLAY.0/untriggered"
  make_trigger ada4571-rate "$1"
  settle
  expect 0 iio-angle record -d shaft --trigger ada4571-rate --samples $count -o capture.csv 2>error
  same rows "$(capture_rows capture.csv | wc -l)" $count
  frames from capture.csv 1.25 >codes
  frames codes codes | awk 'NR > 1 && $3 != (last + 1) % 4096 {print "row " NR; bad = 1}
    {last = $3} END {exit bad}'
  between "duration" "$(column capture.csv time_s | tail -1)" \
    "$(awk "BEGIN {print ($count - 1.5) / $1}")" "$(awk "BEGIN {print ($count - 0.5) / $1}")"
  ! grep lost error
  echo >"$(iio_folder shaft)/trigger/current_trigger"
}

# How old samples are when their angles are there, by the length of the buffer. The first of a buffer
# waits for all the others, or for the 50 ms after which what is there is read; what comes on top of
# that is the way from the trigger to the program.
latency_by_buffer() {
  local hertz=1000 on_top=0.002 # s: of instructions, which is what this clock counts
  frames turn 4096 1 >table
  use_table table
  write 0 "$REPLAY.0/untriggered"
  make_trigger ada4571-rate $hertz
  settle
  expect 0 iio-angle read -d shaft --trigger ada4571-rate --latency --buffers 1,10,100 \
    --samples 2000 --format csv >latency.csv 2>error || { cat error && return 1; }
  awk -F, -v rate=$hertz 'NR > 1 {
      printf "# buffer of %d at %d S/s: age %s s (median), %s s (99 %%), %s s (worst), in buffers %s; processor %s\n",
        $1, rate, $4, $5, $6, $7, $9
    }' latency.csv >ages
  while read -r line; do report "$line"; done <ages
  awk -F, -v rate=$hertz -v more=$on_top 'NR > 1 {
      wait = ($1 - 1) / rate
      if (wait > 0.049) wait = 0.049
      if ($6 < wait || $5 > wait + more || $4 > wait / 2 + more) { print; bad = 1 }
      rows++
    } END { exit bad || rows != 3 }' latency.csv || { cat latency.csv error && return 1; }
  echo >"$(iio_folder shaft)/trigger/current_trigger"
}

# Not a check: the processor time of record beside iio_readdev on the same stream, in the guest.
compare_cpu() {
  local ours theirs TIMEFORMAT='%U %S' count=20000
  write 0 "$REPLAY.0/untriggered"
  make_trigger ada4571-rate 10000
  write ada4571-rate "$(iio_folder shaft)/trigger/current_trigger"
  cd "$SCRATCH" || return
  ours=$({ time iio-angle record -d shaft --samples $count -o cpu.sigmf-meta >/dev/null 2>&1; } 2>&1)
  theirs=$({ time iio_readdev -b 512 -s $count shaft >cpu.raw 2>/dev/null; } 2>&1)
  report "# processor time for $count frames at 10 kS/s: record ${ours} s, iio_readdev ${theirs} s (user system)"
  report "# ratio $(echo "$ours $theirs" | awk '{printf "%.2f", ($1 + $2) / ($3 + $4)}')"
  rm -f cpu.*
  echo >"$(iio_folder shaft)/trigger/current_trigger"
}

load_replay devices=1 labels=shaft
for hertz in 1000 5000 10000; do
  check "10,000 frames at $hertz S/s without a gap" capture_rate $hertz
done
check "samples are as old as their buffer is long" latency_by_buffer
[[ -n $ONLY ]] || compare_cpu
