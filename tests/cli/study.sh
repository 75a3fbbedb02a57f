#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# study.sh BUILD [PATTERN]: iio-angle study as a user runs it, on captures.
set -u
BUILD=$(cd "$1" && pwd)
PATH=$BUILD/tools:$PATH
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"

# capture FILE SEED [KEY=VALUE]... [-- OPTION...]: 2000 samples, with keys in the header
capture() {
  local file=$1 seed=$2 pair keys=''
  shift 2
  while (($#)) && [[ $1 != -- ]]; do
    pair=$1 keys+="# ${pair%%=*} = ${pair#*=}"$'\n'
    shift
  done
  ((!$#)) || shift
  status 0 iio-angle simulate --seed "$seed" --rate 1000 --duration 2 "$@" -o "$file"
  awk -v keys="$keys" 'NR == 2 { printf "%s", keys } !/^# serial =/ { print }' "$file" >with-keys &&
    mv with-keys "$file"
}

quick_captures() { # quick_captures COUNT
  local k
  for ((k = 1; k <= $1; k++)); do
    capture "c$k.csv" "$k" "serial=s$k"
  done
}

rows() { # rows STUDY WHERE
  /usr/bin/python3 - "$@" <<'PYTHON'
import sqlite3, sys
print(sqlite3.connect(sys.argv[1]).execute(f"SELECT count(*) FROM captures WHERE {sys.argv[2]}").fetchone()[0])
PYTHON
}

# json FILE EXPRESSION: what Python says of the JSON in it, as j
json() {
  /usr/bin/python3 -c 'import json, sys; j = json.load(open(sys.argv[1])); print(eval(sys.argv[2]))' "$@"
}

check_a_bad_capture_is_a_row_with_its_sentence_and_the_rest_goes_on() {
  quick_captures 3
  printf '# ada4571-capture/1\ntime_s,vsin_v,vcos_v\n0,1,2\n0.1,x,2\n' >bad.csv
  status 0 iio-angle study run --without diagnose -o s.db c1.csv bad.csv absent.csv c2.csv c3.csv
  says err '^5 captures in .*, 2 failed$'
  same "done" "$(rows s.db "state = 'done'")" 3
  same named "$(rows s.db "reason LIKE 'bad.csv:4:%'")" 1
  same named "$(rows s.db "reason LIKE 'absent.csv%'")" 1
  status 0 iio-angle study report --json s.db
  same failed "$(json out "j['captures'], j['failed'], j['sensors']")" "(5, 2, 3)"
  same schema "$(json out "j['schema']")" ada4571-study/1
  mkdir folder
  status 0 iio-angle study run --without diagnose -o f.db c1.csv folder c2.csv
  same folder "$(rows f.db "reason LIKE 'folder%'")" 1
}

check_a_study_is_a_file_with_a_name() {
  quick_captures 1
  status 2 iio-angle study run --without diagnose -o - c1.csv
  status 0 iio-angle study run --without diagnose -o a.db c1.csv
  mkfifo pipe
  status 1 iio-angle study merge -o pipe a.db
  same sentence "$(cat err)" 'iio-angle: pipe: no place for a database: it is no regular file'
  [[ -p pipe ]] || fail "the pipe is gone"
}

check_a_list_without_lines_is_no_list() {
  status 1 iio-angle study run --list /dev/zero -o s.db
  says err '^iio-angle: /dev/zero: this is no list of names'
}

check_a_capture_is_no_list() {
  quick_captures 1
  iio-angle simulate --duration 0.2 -o a.sigmf-meta 2>err || fail "no capture: $(cat err)"
  local list
  for list in c1.csv a.sigmf-meta a.sigmf-data; do
    status 1 iio-angle study run --list $list -o s.db
    says err "^iio-angle: $list: this is no list of names"
    [[ $(wc -l <err) -eq 1 && ! -e s.db ]] || fail "$list: $(head -3 err; ls)"
  done
  status 1 bash -c "iio-angle study run --list - -o s.db <c1.csv"
  says err '^iio-angle: -: this is no list of names'
}

check_restarted_it_does_only_what_is_left_or_changed() {
  quick_captures 4
  ls c*.csv >names
  status 0 iio-angle study run --without diagnose --list names -o s.db
  says err '^4 captures '
  status 0 iio-angle study run --without diagnose -o s.db
  says err '^0 captures '
  capture c2.csv 77 serial=new
  status 0 iio-angle study run --without diagnose --list names -o s.db
  says err '^1 capture '
  same serial "$(rows s.db "serial = 'new'")" 1
  same rows "$(rows s.db 1)" 4
}

check_an_analysis_that_hangs_or_crashes_costs_itself_alone() {
  quick_captures 2
  mkfifo hang.csv crash.csv # nobody ever writes
  # Longer than a sound one takes on an emulated processor.
  status 0 iio-angle study run --without diagnose --jobs 2 --limit 6 -o s.db hang.csv c1.csv c2.csv
  says err 'hang.csv: the analysis took longer than 6 s'
  same "done" "$(rows s.db "state = 'done'")" 2
  iio-angle study run --without diagnose --jobs 2 --limit 60 -o t.db crash.csv c1.csv c2.csv 2>err &
  local study=$! workers='' i
  for ((i = 0; i < 200; i++)); do # until only the one is left that waits for the pipe
    if [[ $(rows t.db "state = 'done'" 2>/dev/null) == 2 ]]; then
      read -r -d '' -a workers < <(ps -o pid= --ppid "$study")
      [[ ${#workers[@]} != 1 ]] || break
    fi
    sleep 0.1
  done
  kill -SEGV "${workers[0]}"
  wait "$study" || fail "the study ended with $?"
  says err 'crash.csv: the analysis crashed: Segmentation fault'
  same "done" "$(rows t.db "state = 'done'")" 2
}

check_a_stopped_study_says_what_waits_and_goes_on() {
  quick_captures 2
  mkfifo hang.csv
  iio-angle study run --without diagnose --jobs 1 -o s.db c1.csv c2.csv hang.csv 2>err &
  local study=$! i
  for ((i = 0; i < 200; i++)); do
    [[ $(rows s.db "state = 'done'" 2>/dev/null) != 2 ]] || break
    sleep 0.1
  done
  kill -TERM "$study"
  wait "$study" && fail "a stopped study ends with 0"
  says err 'stopped: not done yet: 1 capture;'
  rm hang.csv && capture hang.csv 9
  status 0 iio-angle study run --without diagnose -o s.db
  says err '^1 capture '
  same "done" "$(rows s.db "state = 'done'")" 3
}

check_shards_merge_to_the_same_file_in_any_order() {
  quick_captures 9
  ls c*.csv >names
  local k
  for k in 1 2 3; do
    status 0 iio-angle study run --without diagnose --shard "$k/3" --list names -o "p$k.db"
  done
  status 0 iio-angle study run --without diagnose --jobs 1 --list names -o whole.db
  status 1 iio-angle study merge -o some.db p3.db p1.db
  says err '^shard 2 of 3 is missing$'
  status 1 iio-angle study merge -o some.db p3.db
  says err '^shard 1 of 3 is missing$'
  status 0 iio-angle study merge -o merged.db p3.db p1.db p2.db p1.db
  status 0 iio-angle study merge -o one.db whole.db
  cmp merged.db one.db || fail "merged parts differ from one run"
  status 0 iio-angle study report --json whole.db && mv out whole.json
  status 0 iio-angle study report --json merged.db
  cmp out whole.json || fail "their reports differ"
}

check_what_is_refused_leaves_no_study_behind() {
  quick_captures 1
  status 1 iio-angle study run --without diagnose -o s.db c1.csv $'sch\xf6n.csv'
  says err 'is not UTF-8'
  status 1 iio-angle study run --reports c1.csv/pages -o s.db c1.csv
  says err '^iio-angle: c1.csv/pages: cannot hold reports: '
  absent s.db s.db-wal s.db-shm
  status 0 iio-angle study run --without diagnose -o s.db c1.csv
  status 1 iio-angle study run --without diagnose -o s.db $'sch\xf6n.csv'
  same "rows of the study that was there" "$(rows s.db 1)" 1
}

check_wrong_usage_and_foreign_files() {
  quick_captures 1
  local arguments
  for arguments in "" "run" "run -o new.db" "run --shard 3/2 -o s.db c1.csv" "run --shard x -o s.db c1.csv" \
    "run --without check -o s.db c1.csv" "merge -o s.db" "report" "run -o c1.csv c1.csv"; do
    # shellcheck disable=SC2086
    status 2 iio-angle study $arguments
    empty out
  done
  absent new.db s.db
  printf 'this is text, and it is long enough to be taken for something else\n' >text.db
  for arguments in "report text.db" "report absent.db" "merge -o s.db text.db" "run -o text.db c1.csv"; do
    # shellcheck disable=SC2086
    status 1 iio-angle study $arguments
    says err 'text.db: this is no study|absent.db: there is no such study'
  done
  absent s.db
  status 1 iio-angle study report .
  says err '\.: cannot read: Is a directory'
  status 1 iio-angle study run --list absent.txt -o s.db
  says err 'absent.txt: cannot read: No such file'
  absent s.db
  status 0 iio-angle study run --without diagnose -o s.db c1.csv
  status 2 iio-angle study run -o s.db c1.csv
  says err 'made without the diagnosis'
  # What a result would take the place of is a study, or a page.
  md5sum c1.csv text.db >before
  status 1 iio-angle study merge -o text.db s.db
  says err 'text.db: this is no study'
  status 2 iio-angle study report --report c1.csv s.db
  md5sum --quiet -c before || fail "a file was written over"
}

# A small fleet from end to end: off-axis error proportional to a position, two populations of
# mismatch that no key names; the law is drawn afresh.
check_laws_in_real_captures_are_found() {
  local seed=${ADA4571_TEST_SEED:-$RANDOM} k slope position k_of first
  echo "ADA4571_TEST_SEED=$seed"
  RANDOM=$seed
  slope=$((10 + RANDOM % 20)) # 1e-4 deg per um
  # Ten or eleven of the 26 are of the second population: fewer than five are outliers, and a draw
  # for each would now and then give so few.
  first=$((RANDOM % 5))
  for ((k = 1; k <= 26; k++)); do
    position=$((50 + RANDOM % 200))
    # In 1e-5; drawn here, because a command substitution has random numbers of its own.
    k_of=$((((first + k) % 5 < 2 ? 4000 : 500) + RANDOM % 100))
    capture "c$k.csv" $((seed + k)) "serial=s$k" "position_um=$position" "station=$((k % 2))x" -- \
      --effect "amplitude-mismatch:k=$(awk "BEGIN { print $k_of * 1e-5 }")" \
      --effect "sensor-off-axis:a_deg=$(awk "BEGIN { print $position * $slope * 1e-4 }"),direction_deg=20"
  done
  status 0 iio-angle study run --reports pages -o s.db c*.csv
  status 0 iio-angle study report --json --report page.html s.db
  json out "[(d['slope'], d['std_error']) for d in j['dependences'] if d['parameter'] == 'a_deg' and d['on'] == 'position_um']"
  same "slope of a_deg over position_um" "$(json out "[abs(d['slope'] - $slope * 1e-4) < 6 * d['std_error'] + 1e-6 \
    for d in j['dependences'] if d['parameter'] == 'a_deg' and d['on'] == 'position_um']")" "[True]"
  same populations "$(json out "[(g['parameter'], len(g['sizes'])) for g in j['groups']]")" "[('k', 2)]"
  same enough "$(json out "'amplitude-mismatch' in j['sufficient_model']['effects']")" True
  says page.html 'id="ranking"'
  same pages "$(find pages -name '*.html' | wc -l)" 26
  same link "$(grep -c 'href="pages/' page.html | awk '{ print ($1 >= 0) }')" 1
}

run_checks "${2:-}"
