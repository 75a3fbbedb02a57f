#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# files.sh BUILD [PATTERN]: iio-angle as a user runs it, on files.
set -u
BUILD=$(cd "$1" && pwd)
PATH=$BUILD/tools:$BUILD/tools/examples:$PATH
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"

capture() { # capture FILE [OPTIONS]: a second of the simulated sensor
  local file=$1
  shift
  status 0 iio-angle simulate --seed 4571 --duration 1 "$@" -o "$file"
}

check_help_teaches_every_verb() {
  status 0 iio-angle --help
  empty err
  local verb
  for verb in list record read watch convert simulate emulate diagnose check pins catalogue figures study \
    "calibrate single" "calibrate dual"; do
    says out "^  ${verb%% *} "
  done
  for verb in list record read watch convert simulate emulate diagnose check pins catalogue figures \
    "calibrate single" "calibrate dual" study "study run" "study merge" "study report"; do
    # shellcheck disable=SC2086
    status 0 iio-angle $verb --help
    empty err
    says out '^Example:'
    says out "iio-angle $verb"
  done
  # In words, not in the notes of the library that parses the command line.
  status 0 iio-angle simulate --help
  says out '^  --duration S +length, in s \(default 7\)$'
  says out '^  -o,--output CAPTURE .*\(required\)$'
  status 0 iio-angle emulate --help
  says out '^  --duration S +length, in s, 0 for no end \(default 0\)$'
  status 0 iio-angle list --help
  ! grep -q 'with --save.*with --save' out || fail "list says it twice: $(grep 'with --save' out)"
  status 0 iio-angle --version
  says out '^iio-angle 1\.0\.0$'
}

check_wrong_usage_ends_with_2_and_says_so_on_standard_error() {
  local arguments
  for arguments in "" "nonsense" "record" "record --duration 1" \
    "record --duration 1 --samples 2 -o x.csv" "record --duration -1 -o x.csv" "simulate" \
    "simulate -o x.csv --no-such-option" "simulate --rate nonsense -o x.csv" \
    "simulate --effect no-such-effect -o x.csv" "simulate --effect weak-field:z=1 -o x.csv" \
    "simulate --motion no-such-motion -o x.csv" "convert x.csv -o y.csv" "calibrate" \
    "calibrate single" "calibrate single x.csv -o y.toml --method guess" "read --format xml" \
    "list -s name -u local:" "list --sin foo" "list --no-calibration" "emulate --port 70000" \
    "pins gc sideways" "pins xx on" "check" \
    "diagnose" "figures no-such-figure" "simulate --seed -1 -o x.csv" "simulate --seed 1.5 -o x.csv" \
    "simulate --temperature constant:deg_c=9999 -o x.csv" "diagnose --report y.pdf x.csv" \
    "calibrate single x.csv -o y.txt" "diagnose --extend y.json x.csv" "help nonsense" \
    "catalogue nonsense" "simulate --rate 10parsec -o x.csv" "check --samples"; do
    # shellcheck disable=SC2086
    status 2 iio-angle $arguments
    empty out
    same "lines about '$arguments'" "$(lines err)" 1
    says err '^iio-angle: '
  done
  absent x.csv y.csv y.toml y.pdf y.txt y.json
}

check_help_of_what_there_is_not_is_refused() {
  status 2 iio-angle help calibrate singel
  says err "^iio-angle: 'singel' is no verb of iio-angle calibrate; did you mean 'single'"
  local words
  for words in "list bla" "list --json" "calibrate single dual" "study run x" "--bla"; do
    # shellcheck disable=SC2086
    status 2 iio-angle help $words
    empty out
    says err "^iio-angle: '${words##* }' is one argument too many; see .iio-angle .*--help.$"
  done
  status 2 iio-angle help clibrate single
  says err "did you mean 'calibrate'"
  status 2 iio-angle --jobs 1 check x.csv
  says err "^iio-angle: --jobs: the options of iio-angle check stand behind its name$"
  for words in "" calibrate "calibrate single" "study run" definitions "list --help" -h; do
    # shellcheck disable=SC2086
    status 0 iio-angle help $words
    says out '^Usage: iio-angle'
    empty err
  done
}

# suggests WORD ARGUMENTS...: wrong usage, and what was meant.
suggests() {
  local meant=$1
  shift
  status 2 iio-angle "$@"
  says err "did you mean '$meant'"
}

check_what_was_mistyped_is_guessed() {
  suggests record recrod
  suggests single calibrate sinlge
  suggests single calibrate sinlge x.csv -o x.toml
  suggests report study reprot --json x.db
  suggests --effect simulate --efect x -o x.csv
  suggests --duration record --duraton=10 -o x.csv
  suggests --report diagnose --raport x.html x.csv
  suggests amplitude-mismatch simulate --effect amplitude-mismach -o x.csv
  suggests channel-skew simulate --effect skew -o x.csv
  suggests direction_deg simulate --effect stray-field:b=1,direction=3 -o x.csv
  suggests constant simulate --motion constnat:rpm=3 -o x.csv
  suggests ramp simulate --temperature rmap:from=1 -o x.csv
  suggests csv read --format cvs
  suggests mismatch figures mismach
  suggests hysteresis catalogue hysterisis
  says err "^iio-angle: 'hysterisis' is no effect; did"
  suggests from simulate --motion ramp:frm=3 -o x.csv
  suggests transition simulate --motion steps:transtion=0.1 -o x.csv
  suggests deg_c simulate --temperature constant:degc=3 -o x.csv
  suggests to simulate --temperature cycle:from=1,tto=3 -o x.csv
  status 2 iio-angle qqqqqq
  grep -q 'did you mean' err && fail "'qqqqqq' was meant for nothing"
  mkdir -p config/ada4571
  echo '[source]' >config/ada4571/shaft.toml
  local verb
  for verb in read list "pins gc"; do
    # shellcheck disable=SC2086
    status 1 env XDG_CONFIG_HOME="$PWD/config" iio-angle $verb -s shfat
    says err "shfat.*did you mean 'shaft'"
  done
  absent x.csv x.html x.toml
}

check_wrong_values_name_their_option_first() {
  names() { # names OPTION ARGUMENTS...
    local option=$1
    shift
    status 2 iio-angle "$@"
    says err "^iio-angle: $option: "
  }
  names --effect simulate --effect nonsense -o x.csv
  names --effect simulate --effect weak-field:q=77 -o x.csv
  names --motion simulate --motion nonsense -o x.csv
  names --motion simulate --motion steps:transition=7 -o x.csv
  names --temperature simulate --temperature constant:deg_c=9999 -o x.csv
  names --rate simulate --rate 10parsec -o x.csv
  names --seed simulate --seed -1 -o x.csv
  names --bits simulate --bits 33 -o x.csv
  names --rate simulate --rate 1GHz -o x.csv
  names --duration simulate --duration 0 -o x.csv
  names --duration simulate --duration 1e9 -o x.csv
  names --duration emulate --duration 1e9
  names --motion simulate --motion constant:600 -o x.csv
  says err "'600' is no parameter of constant \(rpm\)"
  names --temperature simulate --temperature ramp:rpm=3 -o x.csv
  local verb name
  for name in a.txt a a.csv.gz .csv csv a.sigmf /dev/null; do
    for verb in simulate "import b.csv" record; do
      # shellcheck disable=SC2086
      names --output $verb -o "$name"
      says err "'$name' is no name for a capture: let it end in .csv or .sigmf-meta$"
    done
  done
  absent a.txt a a.csv.gz .csv csv a.sigmf
  names --report diagnose --report y.pdf x.csv
  names --output calibrate single x.csv -o y.txt
  names --latency read --latency --capture x.csv
  names --speed emulate --capture x.csv --speed 0
  names --rate import x.csv --rate 2GHz -o y.csv
  names --continue record --continue -o x.csv
  names --format read --format xml
  names --format convert --format xx --calibration x.toml x.csv -o y.csv
  names --output simulate -o
  names --duration record --duration 1 --samples 2 -o x.csv
  names --sin list --sin foo
  names --uri list --uri local: --uri local:
  says err 'given more than once'
  ! grep -qE '[0-9]{30}' err || fail "a number of thirty digits is no help"
}

check_units_are_taken() {
  local pair
  status 0 iio-angle simulate --seed 1 --rate 2000 --duration 0.5 --noise 0.0005 \
    --effect channel-skew:dt_s=4e-6 --motion steps:rpm=600/-60 --temperature constant:deg_c=-20 -o a.csv
  status 0 iio-angle simulate --seed 1 --rate 2kHz --duration 500ms --noise 0.5mV \
    --effect channel-skew:dt_s=4us --motion steps:rpm=10Hz/-360deg/s --temperature constant:deg_c=-20C \
    -o b.csv
  cmp -s a.csv b.csv || fail "units change the capture"
  for pair in 1min:60.0 0.0005h:1.8 1500ms:1.5; do
    status 0 iio-angle simulate --rate 10 --duration "${pair%:*}" --no-vtemp --no-vdd -o c.csv
    same "rows of ${pair%:*}" "$(column c.csv vsin_v | wc -l)" "$(awk "BEGIN { print ${pair#*:} * 10 }")"
  done
  status 2 iio-angle simulate --duration 5m -o d.csv --rate 5V
  absent d.csv
}

check_help_and_version_in_their_usual_forms() {
  local form
  status 0 iio-angle record --help
  cp out help
  for form in "help record" "record -h"; do
    # shellcheck disable=SC2086
    status 0 iio-angle $form
    cmp -s out help || fail "'$form' is not 'record --help'"
  done
  status 0 iio-angle help calibrate single
  says out '^Example:'
  status 0 iio-angle help
  says out '^  record '
  status 0 iio-angle -V
  says out '^iio-angle 1\.0\.0$'
  status 0 iio-angle help list
  # What help and errors point to is there when only the packages are.
  local verb
  for verb in "" list record read watch calibrate convert simulate emulate diagnose check pins \
    catalogue figures; do
    # shellcheck disable=SC2086
    iio-angle $verb --help | grep -E '[a-z]+/[a-z-]+\.(md|c|h|cpp)\b' &&
      fail "help of '$verb' points to a file of the source tree"
  done
  return 0
}

check_the_catalogue_shows_one_effect_or_all_as_text_or_json() {
  status 0 iio-angle catalogue channel-skew
  same "effects" "$(grep -c '^[a-z]' out)" 1
  says out 'dt_s +s +default .* to '
  status 0 iio-angle catalogue --json
  /usr/bin/python3 -c 'import json, sys
c = json.load(sys.stdin)
assert c["schema"] == "ada4571-catalogue/1" and len(c["effects"]) >= 20
for e in c["effects"]:
    for p in e["parameters"]:
        if "choices" in p:
            assert p["default"] in [None, *p["choices"]], p
            continue
        low = -1e300 if p["minimum"] is None else p["minimum"]
        high = 1e300 if p["maximum"] is None else p["maximum"]
        assert p["unit"] and low < high and (p["default"] is None or low <= p["default"] <= high), p
' <out 2>json.err || fail "$(tail -1 json.err)"
}

check_long_work_shows_progress_on_a_terminal_only() {
  # Long enough for more than a second on any machine; the terminal is made by script(1).
  script -qec "iio-angle simulate --duration 400 -o a.csv" /dev/null </dev/null >shown 2>&1
  says shown '(simulating|writing a\.csv), [0-9]+ s'
  status 0 iio-angle simulate --duration 400 -o a.csv
  empty err
}

check_unusable_files_end_with_1_name_the_place_and_leave_nothing() {
  printf '# ada4571-capture/1\ntime_s,vsin_v,vcos_v\n0,1,2\n0.1,x,2\n' >bad.csv
  printf 'nonsense\n' >model.toml
  local verb
  for verb in "check" "diagnose" "calibrate single -o out.toml"; do
    # shellcheck disable=SC2086
    status 1 iio-angle $verb bad.csv
    empty out
    says err 'bad\.csv:4:[0-9]+'
    same "lines of '$verb'" "$(lines err)" 1
  done
  capture good.csv
  status 1 iio-angle convert --calibration model.toml good.csv -o out.csv
  says err 'model\.toml'
  status 1 iio-angle convert --calibration nowhere.toml good.csv -o out.csv
  status 1 iio-angle check nowhere.csv
  says err 'nowhere\.csv'
  status 1 iio-angle simulate -o /nowhere/x.csv
  absent out.csv out.toml
  same "files left" "$(find . -type f -name '*.??????' | wc -l)" 0
}

check_a_seed_is_any_number_of_64_bits() {
  status 0 iio-angle simulate --seed 18446744073709551615 --rate 100 --duration 1 -o a.csv
  says a.csv '^# origin = simulation, seed 18446744073709551615$'
  status 2 iio-angle simulate --seed 18446744073709551616 --rate 100 --duration 1 -o b.csv
  says err "'18446744073709551616' is above 18446744073709551615"
}

check_simulate_is_the_same_for_a_seed_and_another_for_another() {
  capture a.csv
  capture b.csv
  cmp -s a.csv b.csv || fail "one seed, two captures"
  status 0 iio-angle simulate --seed 1 --duration 1 -o c.csv
  ! cmp -s <(tail -n +20 a.csv) <(tail -n +20 c.csv) || fail "two seeds, one capture"
  same rows "$(column a.csv vsin_v | wc -l)" 10000
  capture d.csv --no-vtemp --no-vdd --no-reference --rate 1000
  same header "$(grep -v '^#' d.csv | head -1)" time_s,vsin_v,vcos_v
  same rows "$(column d.csv vsin_v | wc -l)" 1000
}

check_every_effect_of_the_catalogue_can_be_simulated() {
  status 0 iio-angle catalogue
  local effect count=0
  local effects
  mapfile -t effects < <(sed -n 's/^\([a-z-]*\)  (.*/\1/p' out)
  for effect in "${effects[@]}"; do
    status 0 iio-angle simulate --duration 1 --rate 2000 --effect "$effect" -o "$effect.csv"
    count=$((count + 1))
    rm "$effect.csv"
  done
  ((count >= 20)) || fail "only $count effects in the catalogue"
}

# Largest difference of the angles from the reference, which `simulate` records without error: the
# noise of 0.5 mV rms is 0.01 deg rms, so 0.06 deg is six times that.
worst_error() {
  paste -d, <(column "$1" angle_deg) <(column "$2" reference_deg) |
    awk -F, '{ d = $1 - $2; d -= 180 * int(d / 180 + (d > 0 ? 0.5 : -0.5)); d = d < 0 ? -d : d
               if (d > worst) worst = d } END { print (NR > 0 && worst < 0.06) ? "small" : worst }'
}

# rms over both channels: 1.45 V * sqrt((0.02^2 + 0.01^2 + 0.02^2 + 0.015^2) / 4) = 24.3 mV.
check_a_remainder_is_simulated_taken_out_and_called_unnamed() {
  {
    echo 'schema = "ada4571-model/1"'
    echo 'periods_per_turn = 2'
    echo 'supply_v = 5'
    echo 'baseline = {amplitude_v = 1.45, offset_sin_v = 0, offset_cos_v = 0}'
  } >plain.toml
  {
    cat plain.toml
    echo '[remainder]'
    echo 'angle = "electrical"'
    echo 'orders = 3'
    echo 'sin_cos = [0.02, 0, 0]'
    echo 'sin_sin = [0, 0, 0.01]'
    echo 'cos_cos = [0, 0.02, 0]'
    echo 'cos_sin = [0.015, 0, 0]'
  } >unnamed.toml
  status 0 iio-angle simulate --model unnamed.toml --noise 0 --bits 0 --duration 0.2 -o a.csv
  status 0 iio-angle convert --calibration unnamed.toml a.csv -o with.csv
  says err '^unnamed: .* 24.3 mV rms, up to order 3 of the electrical period$'
  status 0 iio-angle convert --calibration plain.toml a.csv -o without.csv
  empty err
  # The reference is the shaft itself; both angles are within half a turn.
  local column
  column=$(grep -v '^#' a.csv | head -1 | tr , '\n' | grep -n reference_deg | cut -d: -f1)
  for name in with without; do
    paste -d, <(grep -v '^#' a.csv | cut -d, -f"$column") "$name.csv" |
      awk -F, 'NR > 1 { e = $3 - $1; e -= 180 * int(e / 180 + (e < 0 ? -0.5 : 0.5));
                        if (e < 0) e = -e; if (e > worst) worst = e } END { print worst }' >"$name"
  done
  awk '{ exit !($1 < 0.001) }' with || fail "off by $(cat with) degrees with the remainder"
  awk '{ exit !($1 > 0.2) }' without || fail "off by only $(cat without) degrees without"
}

check_convert_gives_the_angle_of_every_sample() {
  capture a.csv --temperature constant:deg_c=25
  status 0 iio-angle calibrate single a.csv -o a.toml
  says out '^amplitude +1\.4'
  status 0 iio-angle convert --calibration a.toml a.csv -o angles.csv
  empty out
  same header "$(head -1 angles.csv)" time_s,angle_deg,radius,status
  same rows "$(column angles.csv angle_deg | wc -l)" 10000
  same error "$(worst_error angles.csv a.csv)" small
  same "unsound samples" "$(column angles.csv status | grep -cv '^0$')" 0
  awk -F, 'NR > 1 && ($2 < 0 || $2 >= 180 || $3 < 0.99 || $3 > 1.01) { exit 1 }' angles.csv ||
    fail "an angle or a radius is out of its range"
  status 0 iio-angle convert --dynamic --calibration a.toml a.csv -o dynamic.csv
  same error "$(worst_error dynamic.csv a.csv)" small
}

check_every_method_calibrates() {
  capture a.csv --motion constant:rpm=600 --temperature constant:deg_c=25
  local method
  for method in fit mean extrema; do
    status 0 iio-angle calibrate single --method "$method" a.csv -o "$method.toml"
    status 0 iio-angle convert --calibration "$method.toml" a.csv -o "$method.csv"
    same "$method" "$(worst_error "$method.csv" a.csv)" small
  done
}

check_two_temperatures_calibrate_and_one_is_refused() {
  capture cold.csv --temperature constant:deg_c=0
  capture hot.csv --temperature constant:deg_c=110
  capture warm.csv --temperature constant:deg_c=60
  status 0 iio-angle calibrate dual cold.csv hot.csv -o dual.toml
  says out offset-temperature-drift
  status 0 iio-angle convert --calibration dual.toml warm.csv -o warm-angles.csv
  same error "$(worst_error warm-angles.csv warm.csv)" small
  status 1 iio-angle calibrate dual cold.csv cold.csv -o same.toml
  [[ -s err ]] || fail "no reason given"
  absent same.toml
}

check_a_dash_is_standard_input_and_output() {
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  status 0 iio-angle convert --calibration a.toml a.csv -o file.csv
  iio-angle simulate --seed 4571 --duration 1 -o - | cmp -s - a.csv ||
    fail "simulate -o - is not what a file gets"
  iio-angle convert --calibration a.toml - -o - <a.csv | cmp -s - file.csv ||
    fail "convert - -o - is not what files get"
  iio-angle simulate --seed 4571 --duration 1 -o - | iio-angle check - >out || fail "check -"
  says out '^sound$'
}

check_sigmf_is_taken_wherever_text_is() {
  capture a.csv
  capture a.sigmf-meta
  [[ -s a.sigmf-data ]] || fail "no data file"
  status 0 iio-angle calibrate single a.sigmf-meta -o a.toml
  status 0 iio-angle convert --calibration a.toml a.csv -o from-text.csv
  status 0 iio-angle convert --calibration a.toml a.sigmf-meta -o from-sigmf.csv
  same rows "$(lines from-sigmf.csv)" "$(lines from-text.csv)"
  # Text holds volts to a millionth, which is 1e-5 deg at most.
  paste -d, <(column from-text.csv angle_deg) <(column from-sigmf.csv angle_deg) |
    awk -F, '{ d = $1 - $2; if (d < 0) d = -d; if (d > 1e-4 && d < 179.9999) exit 1 }' ||
    fail "the two forms give two angles"
}

check_convert_wants_a_name_that_says_the_form() {
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  local name
  for name in y.txt y.toml y.npy y y.sigmf; do
    status 2 iio-angle convert --calibration a.toml a.csv -o "$name"
    says err "^iio-angle: --output: '$name' is no name for a file of angles: let it end in .csv or .sigmf-meta, or"
    absent "$name"
    status 2 iio-angle convert --format sigmf --calibration a.toml a.csv -o "$name"
    says err "^iio-angle: --format: sigmf does not go with the name '$name': .* in .sigmf-meta$"
    absent "$name"
  done
  status 2 iio-angle convert --format sigmf --calibration a.toml a.csv -o -
  says err "^iio-angle: --format: sigmf does not go with the name '-'"
  status 2 iio-angle convert --format csv --calibration a.toml a.csv -o y.sigmf-meta
  says err "^iio-angle: --format: csv does not go with the name 'y.sigmf-meta'"
  absent y.sigmf-meta y.sigmf-data
  status 0 iio-angle convert --calibration a.toml a.csv -o y.csv
  status 0 iio-angle convert --format csv --calibration a.toml a.csv -o y.txt
  cmp -s y.csv y.txt || fail "--format csv is another CSV"
  status 0 iio-angle convert --calibration a.toml a.csv -o -
  cmp -s y.csv out || fail "standard output is another CSV"
  status 0 iio-angle convert --calibration a.toml a.csv -o /dev/null
}

check_convert_writes_sigmf() {
  capture a.sigmf-meta
  status 0 iio-angle calibrate single a.sigmf-meta -o a.toml
  status 0 iio-angle convert --calibration a.toml a.sigmf-meta -o angles.csv
  status 0 iio-angle convert --calibration a.toml a.sigmf-meta -o angles.sigmf-meta
  empty out
  [[ -s angles.sigmf-data ]] || fail "no data file"
  # The words are in the order of the machine that wrote them, and the meta file says which.
  local order=little
  ! grep -q '"core:datatype": "rf32_be"' angles.sigmf-meta || order=big
  # 32-bit floats hold an angle below 180 degrees to 1e-5.
  od --endian=$order -An -v -tf4 -w12 angles.sigmf-data | tr -s ' ' , | paste -d, <(sed 1d angles.csv) - |
    awk -F, '{ a = $2 - $6; r = $3 - $7 }
             a * a > 4e-10 || r * r > 1e-12 || $4 != $8 || NF != 8 { exit 1 }' ||
    fail "the two forms give two angles"
  same rows "$(($(stat -c %s angles.sigmf-data) / 12))" 10000
  status 2 iio-angle convert --format csv --calibration a.toml a.sigmf-meta -o angles.sigmf-meta
  status 2 iio-angle convert --format sigmf --calibration a.toml a.sigmf-meta -o other.csv
  absent other.csv
}

check_the_number_of_jobs_changes_nothing() {
  iio-angle simulate --seed 4571 --rate 100k --duration 3 -o long.sigmf-meta
  local jobs
  for jobs in 1 2 5; do
    status 0 iio-angle calibrate single --jobs $jobs long.sigmf-meta -o $jobs.toml
    status 0 iio-angle convert --jobs $jobs --calibration 1.toml long.sigmf-meta -o $jobs.csv
    iio-angle check --jobs $jobs long.sigmf-meta >$jobs.check
    grep -v -e '^date' -e '^checksum' $jobs.toml >$jobs.plain
    for form in plain csv check; do
      cmp -s 1.$form $jobs.$form || fail "$form differs with $jobs jobs"
    done
  done
  status 2 iio-angle check --jobs 0 long.sigmf-meta
}

check_a_file_that_is_cut_short_meanwhile_is_an_error() {
  iio-angle simulate --seed 4571 --rate 1M --duration 2 -o long.sigmf-meta
  local whole reader
  whole=$(stat -c %s long.sigmf-data)
  iio-angle diagnose --jobs 1 long.sigmf-meta >out 2>err &
  reader=$!
  while kill -0 $reader && [[ -z $(find "/proc/$reader/fd" -lname "*long.sigmf-data") ]]; do sleep 0.01; done
  truncate -s $((whole / 4)) long.sigmf-data
  wait $reader && fail "no error"
  same status $? 1
  says err 'cut short|does not fit the checksum' # by when it was
  same lines "$(lines err)" 1
}

check_results_replace_a_file_whole_or_not_at_all() {
  capture a.csv
  status 0 iio-angle calibrate single a.csv -o a.toml
  echo precious >angles.csv
  status 1 iio-angle convert --calibration a.toml nowhere.csv -o angles.csv
  same "old file" "$(cat angles.csv)" precious
  ln -s angles.csv link.csv
  status 0 iio-angle convert --calibration a.toml a.csv -o link.csv
  [[ -L link.csv ]] || fail "the link was replaced"
  same header "$(head -1 angles.csv)" time_s,angle_deg,radius,status
  if [[ -w /dev/full ]]; then
    status 1 iio-angle convert --calibration a.toml a.csv -o /dev/full
    says err 'No space left'
  fi
}

check_check_tells_a_healthy_sensor_from_faults() {
  capture good.csv
  status 0 iio-angle check good.csv
  says out '^sound$'
  status 0 iio-angle check --json good.csv
  says out '"schema": "ada4571-check/1"'
  says out '"sound": true'
  status 0 iio-angle calibrate single good.csv -o good.toml
  fault() { # fault CHECK FILE: this check fails, and the exit status says so
    status 1 iio-angle check --calibration good.toml "$2"
    says out "^$1 +failed"
    says out '^NOT sound'
  }
  local edit='BEGIN { FS = OFS = "," } /^#/ || /time_s/ { print; next } { n++ }'
  awk "$edit n > 5000 { \$2 = 2.5 } { print }" good.csv >mid.csv
  fault stuck mid.csv
  fault radius mid.csv
  awk "$edit n > 5000 { \$2 = 0.001 } { print }" good.csv >ground.csv
  fault rails ground.csv
  awk "$edit { \$3 = \$2 } { print }" good.csv >short.csv
  fault short short.csv
  awk "$edit n <= 5000 || n > 5050 { print }" good.csv >gap.csv
  fault gaps gap.csv
  awk "$edit { \$2 = \$2 > 3.6 ? 3.6 : \$2; print }" good.csv >clipped.csv
  fault clipping clipped.csv
  capture noisy.csv --noise 0.002
  sed -i 's/^# noise_rms_v.*/# noise_rms_v = 0.0005/' noisy.csv
  fault noise noisy.csv
  awk "$edit { \$2 = \$3 = 2.5; print }" good.csv >unpowered.csv
  fault radius unpowered.csv
}

check_diagnose_says_what_is_missing_and_ends_with_1() {
  status 0 iio-angle simulate --motion constant:rpm=0 --duration 1 -o rest.csv
  status 0 iio-angle simulate --duration 0.01 -o short.csv
  local file
  for file in rest short; do
    status 1 iio-angle diagnose $file.csv
    says out '^Not enough data: '
    empty err
    status 1 iio-angle diagnose --json --report $file.html --extend $file.toml $file.csv
    says out '"verdict": "insufficient-data"'
    says out '"reason"'
    same sentences "$(lines err)" 1
    [[ -s $file.html ]] || fail "no page"
    absent $file.toml
  done
}

check_diagnose_finds_names_and_models() {
  status 0 iio-angle simulate --seed 4571 --duration 4 --effect amplitude-mismatch:k=0.02 -o a.csv
  status 0 iio-angle diagnose a.csv
  says out amplitude-mismatch
  empty err
  status 0 iio-angle diagnose --json --extend a.toml --report a.html a.csv
  says out '"schema": *"ada4571-diagnosis/1"'
  says out '"cause": *"amplitude-mismatch"'
  says a.html '</html>'
  status 0 iio-angle convert --calibration a.toml a.csv -o angles.csv
  same error "$(worst_error angles.csv a.csv)" small
}

check_a_saved_model_simulates_the_same_sensor() {
  status 0 iio-angle simulate --duration 1 --seed 4571 --effect weak-field:q=0.01 \
    --save-model a.toml -o a.csv
  status 0 iio-angle simulate --duration 1 --seed 4571 --model a.toml -o b.csv
  cmp -s <(column a.csv vsin_v) <(column b.csv vsin_v) || fail "the model file changes the sensor"
}

check_examples_run() {
  capture a.csv
  status 0 calibrate_recording a.csv a.toml
  says out '^offsets .* amplitude 1\.4'
  status 0 diagnose_recording a.csv
  [[ -s out ]] || fail "nothing said"
  status 1 diagnose_recording nowhere.csv
  status 2 calibrate_recording
}

check_figures_are_written() {
  status 0 iio-angle figures mismatch -o .
  [[ -s mismatch.csv ]] || fail "no data"
  status 2 iio-angle figures mismatch -o /nowhere
}

run_checks "${2:-}"
