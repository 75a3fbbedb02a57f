#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# import.sh BUILD [PATTERN]: measurements of other programs, and captures that change their form.
set -u
BUILD=$(cd "$1" && pwd)
PATH=$BUILD/tools:$PATH
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"

simulate() {
  iio-angle simulate --seed 4571 --duration 2 -o a.csv 2>err || fail "$(cat err)"
}

# as_scope FILE: a.csv as an oscilloscope would write it, in milliseconds and millivolts.
as_scope() {
  awk -F, 'BEGIN { print "Model;X1\nZeit;CH1;CH2\n(ms);(mV);(mV)\n" } /^[0-9]/ {
    line = sprintf("%.6f;%.4f;%.4f", 1e3 * $1, 1e3 * $2, 1e3 * $3); gsub(/\./, ",", line); print line
  }' a.csv >"$1"
}

check_a_scope_file_gives_the_capture_that_it_was_made_of() {
  simulate
  as_scope scope.csv
  status 0 iio-angle import --sin CH1 --cos CH2 scope.csv -o b.csv
  empty out
  says err "^rows from line 5, separator ';', decimal mark ','$"
  says err "^vsin_v: column 2 'CH1', in mV$"
  says err '^sample rate: 10000 Hz, from the times$'
  says err '^20000 samples$'
  for name in time_s vsin_v vcos_v; do
    same "$name" "$(column b.csv $name | md5sum)" "$(column a.csv $name | md5sum)"
  done
  says b.csv '^# origin = import of scope.csv$'
  status 0 iio-angle calibrate single b.csv -o b.toml
}

check_metadata_of_a_capture_without_its_first_line_are_said_to_be_unread() {
  simulate
  tail -n +2 a.csv >headless.csv
  status 0 iio-angle import headless.csv -o b.csv
  says err "^not read: '# supply_v = 5' of line 1 and [0-9]+ more; metadata are read where the first line is '# ada4571-capture/1'$"
  grep -v '^#' a.csv >bare.csv
  status 0 iio-angle import bare.csv -o b.csv
  ! grep -q 'not read' err || fail "nothing was there to read: $(cat err)"
}

check_what_is_ambiguous_is_asked_for_and_nothing_is_written() {
  simulate
  as_scope scope.csv
  status 2 iio-angle import scope.csv -o b.csv
  says err "^iio-angle: --sin: scope.csv:2: no column is known to be VSIN: .*2 'CH1', 3 'CH2'; see"
  status 2 iio-angle import --sin 2 --cos 9 scope.csv -o b.csv
  status 2 iio-angle import --sin 2 --cos 3 --scale sin=x scope.csv -o b.csv
  says err 'sin=0.001'
  status 2 iio-angle import scope.csv
  echo '7;x;1' >>scope.csv
  status 1 iio-angle import --sin 2 --cos 3 scope.csv -o b.csv
  says err "scope.csv:20005:3: 'x' is no number for vsin_v$"
  absent b.csv
  status 1 iio-angle import no-such-file -o b.csv
}

check_the_question_leads_to_the_options() {
  printf 'a,b\n1,2\n2,3\n3,4\n' >unnamed.csv
  status 2 iio-angle import unnamed.csv -o x.csv
  says err '^iio-angle: --time: .*: give --time or --rate; .*; see .iio-angle import --help.$'
  status 2 iio-angle import --time none --sin a --cos b unnamed.csv -o x.csv
  says err '^iio-angle: --rate: .*give the sample rate by --rate'
  status 2 iio-angle import --rate 100 --cos b unnamed.csv -o x.csv
  says err '^iio-angle: --sin: .*known to be VSIN: give --sin;'
  status 2 iio-angle import --rate 100 --sin a unnamed.csv -o x.csv
  says err '^iio-angle: --cos: .*known to be VCOS: give --cos;'
  status 2 iio-angle import --rate 100 --sin a --cos c unnamed.csv -o x.csv
  says err "^iio-angle: --cos: .*no column 'c' for --cos; there are 1 'a', 2 'b'"
  status 2 iio-angle import --rate 100 --sin a --cos a unnamed.csv -o x.csv
  says err '^iio-angle: --sin: .*cannot be both'
  status 2 iio-angle import --sin a --cos b --separator x unnamed.csv -o x.csv
  says err "^iio-angle: --separator: 'x' is not bar, blank, comma, semicolon or tab$"
  status 2 iio-angle import --sin a --cos b --separator comm unnamed.csv -o x.csv
  says err "did you mean 'comma'"
  local separator
  for separator in ',' comma; do
    status 0 iio-angle import --rate 100 --sin a --cos b --separator $separator unnamed.csv -o y.csv
  done
  for separator in ';' semicolon tab blank bar; do
    status 1 iio-angle import --rate 100 --sin a --cos b --separator "$separator" unnamed.csv -o x.csv
  done
  printf 'Time [s],CH1 [V],CH2 [V]\n0,1,2\n1,2,3\n2,3,4\n' >units.csv
  status 0 iio-angle import --sin 'CH1 [V]' --cos 'CH2 [V]' units.csv -o y.csv
  absent x.csv
}

check_explain_says_and_writes_nothing() {
  simulate
  as_scope scope.csv
  status 0 iio-angle import --explain --sin CH1 --cos CH2 scope.csv
  empty out
  says err '^time_s: column 1 .Zeit., in ms$'
}

check_a_pipe_and_a_rate() {
  simulate
  awk -F, '/^[0-9]/ { print $2 "\t" $3 }' a.csv |
    iio-angle import --sin 1 --cos 2 --rate 10000 - -o - >b.csv 2>err || fail "$(cat err)"
  same vsin "$(column b.csv vsin_v | md5sum)" "$(column a.csv vsin_v | md5sum)"
  same rate "$(grep -c '^# sample_rate_hz = 10000$' b.csv)" 1
}

check_the_input_is_never_written_over() {
  simulate
  as_scope scope.csv
  ln -s scope.csv link.csv
  cp scope.csv before
  status 2 iio-angle import --sin CH1 --cos CH2 scope.csv -o link.csv
  cmp -s scope.csv before || fail "the input was changed"
}

check_csv_becomes_sigmf_and_csv_again() {
  simulate
  status 0 iio-angle import a.csv -o b.sigmf-meta
  [[ -s b.sigmf-data ]] || fail "no data"
  status 0 iio-angle import b.sigmf-meta -o c.csv
  cmp -s a.csv c.csv || fail "the way there and back changes it: $(diff a.csv c.csv | head -3)"
  status 2 iio-angle import --sin 2 a.csv -o d.csv
  says err '^iio-angle: --sin: a.csv is a capture already'
  status 2 iio-angle import a.csv -o ./a.csv
}

check_what_numpy_saves() {
  /usr/bin/python3 - <<'EOF' || fail "numpy"
import numpy as np
t = np.arange(3000) / 1000
sin, cos = 2.5 + np.sin(t), 2.5 + np.cos(t)
np.save("table.npy", np.column_stack([t, sin, cos]))
np.save("rows.npy", np.asfortranarray(np.stack([sin, cos]).astype("f4")))
np.save("records.npy", np.array(list(zip(t, sin, cos)), dtype=[("t", "<f8"), ("vsin", ">f8"), ("vcos", "<f4")]))
EOF
  status 0 iio-angle import --time 1 --sin 2 --cos 3 table.npy -o a.csv
  same rows "$(column a.csv vsin_v | wc -l)" 3000
  status 0 iio-angle import --sin 1 --cos 2 --rate 1000 rows.npy -o b.csv
  same time "$(column b.csv time_s | md5sum)" "$(column a.csv time_s | md5sum)"
  status 0 iio-angle import records.npy -o c.csv
  same vsin "$(column c.csv vsin_v | md5sum)" "$(column a.csv vsin_v | md5sum)"
}

check_a_capture_from_standard_input_keeps_its_metadata() {
  iio-angle simulate --seed 4571 --duration 0.1 -o a.csv || fail "simulate"
  sed -i 's/^# periods_per_turn = .*/# periods_per_turn = 100/' a.csv
  status 0 iio-angle import a.csv -o named.csv
  status 0 bash -c 'cat a.csv | iio-angle import - -o b.csv'
  same piped "$(md5sum <b.csv)" "$(md5sum <named.csv)"
  status 0 bash -c 'iio-angle import - -o c.csv <a.csv'
  same redirected "$(md5sum <c.csv)" "$(md5sum <named.csv)"
  grep -v '^#' a.csv >bare.csv
  status 0 bash -c 'cat bare.csv | iio-angle import --periods 65536 - -o d.csv'
  same periods "$(grep -c '^# periods_per_turn = 65536$' d.csv)" 1
  /usr/bin/python3 -c 'import numpy; numpy.save("x.npy", numpy.zeros((9, 3)))'
  status 1 bash -c 'cat x.npy | iio-angle import --time 1 --sin 2 --cos 3 - -o e.csv'
  same sentence "$(cat err)" \
    "iio-angle: standard input: numpy's .npy is read from a file that has a name"
  status 1 bash -c 'sleep 0.2 | iio-angle import - -o f.csv'
  [[ ! -e e.csv && ! -e f.csv ]] || fail "a file was written"
}

check_a_million_rows_take_no_more_memory_than_a_thousand() {
  rows() {
    awk -v n="$1" 'BEGIN { print "t,sin,cos"; for (i = 0; i < n; i++) printf "%.6f,%.4f,2.5\n", i * 1e-5, i % 7 }'
  }
  peak() { # kilobytes
    /usr/bin/python3 -c 'import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stderr=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)' "$@"
  }
  rows 1000 >small.csv
  rows 1000000 >large.csv
  local small large
  small=$(peak iio-angle import small.csv -o b.csv)
  large=$(peak iio-angle import large.csv -o c.csv)
  same rows "$(column c.csv vsin_v | wc -l)" 1000000
  # The frames alone would be 48 MB.
  ((large < small + 16000)) || fail "1e3 rows take $small kB, 1e6 take $large kB"
}

run_checks "${2:-}"
