# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash disable=SC2034
#
# Words for the classes in classes/. A class is an executable, called with the build folder and
# "short" or "full" in an empty folder of its own; it prints what failed, and closes with
# "tries N failures M".

BUILD=$1 FORM=${2:-full}
PATH=$BUILD/tools:$PATH
CALLS=(open write room fsync rename link truncate)
TRIES=0 FAILURES=0

# passed, or failed WHAT...: one try more.
passed() {
  TRIES=$((TRIES + 1))
}

failed() {
  TRIES=$((TRIES + 1))
  FAILURES=$((FAILURES + 1))
  echo "    $*"
}

close_class() {
  echo "tries $TRIES failures $FAILURES"
}

# The library that makes system calls fail.
build_shim() {
  cc -shared -fPIC -O1 -o "$PWD/shim.so" "$(dirname "${BASH_SOURCE[0]}")/shim.c" -ldl
  SHIM=$PWD/shim.so
}

# What a verb is to do, by its name: the arguments of iio-angle for the target $1, which lies in a
# folder of its own. What they read is in inputs/.
JOBS=(simulate-csv simulate-sigmf calibrate convert)
[[ $FORM == short ]] || JOBS+=(diagnose record-csv record-sigmf continue-sigmf)

job() { # job NAME: sets TARGET and COMMAND
  local out=$PWD/out in=$PWD/inputs
  case $1 in
    simulate-csv) TARGET=$out/a.csv COMMAND=(simulate --seed 2 --duration 0.3 -o "$TARGET") ;;
    simulate-sigmf) TARGET=$out/a.sigmf-meta COMMAND=(simulate --seed 2 --duration 0.3 -o "$TARGET") ;;
    calibrate) TARGET=$out/a.toml COMMAND=(calibrate single "$in/new.csv" -o "$TARGET") ;;
    convert) TARGET=$out/a.csv COMMAND=(convert --calibration "$in/old.toml" "$in/new.csv" -o "$TARGET") ;;
    diagnose) TARGET=$out/a.toml COMMAND=(diagnose --extend "$TARGET" "$in/new.csv") ;;
    record-csv) TARGET=$out/a.csv COMMAND=(record -u "$URI" --samples 300 -o "$TARGET") ;;
    record-sigmf) TARGET=$out/a.sigmf-meta COMMAND=(record -u "$URI" --samples 300 -o "$TARGET") ;;
    continue-sigmf) TARGET=$out/a.sigmf-meta COMMAND=(record -u "$URI" --samples 300 --continue -o "$TARGET") ;;
  esac
}

# Inputs of the jobs, and the simulated sensor for those that record.
prepare_jobs() {
  local i
  mkdir -p inputs out
  iio-angle simulate --seed 1 --duration 0.5 -o inputs/old.csv
  iio-angle simulate --seed 2 --duration 0.4 --motion constant:rpm=1200 -o inputs/new.csv
  iio-angle calibrate single inputs/old.csv -o inputs/old.toml >/dev/null 2>&1
  [[ $FORM != short ]] || return 0
  iio-angle emulate --seed 1 >uri 2>/dev/null </dev/null &
  EMULATOR=$!
  trap 'kill "$EMULATOR"' EXIT
  for ((i = 0; i < 200; i++)); do
    [[ ! -s uri ]] || break
    sleep 0.05
  done
  URI=$(cat uri)
}

# place OLD|NOTHING JOB: what is there before it runs.
place() {
  rm -rf out
  mkdir out
  [[ $1 == old ]] || return 0
  case $2 in
    *-csv) cp inputs/old.csv "$TARGET" ;;
    convert) echo old >"$TARGET" ;;
    continue-sigmf) iio-angle record -u "$URI" --samples 200 -o "$TARGET" 2>/dev/null ;;
    *-sigmf) iio-angle simulate --seed 1 --duration 0.2 -o "$TARGET" ;;
    *) cp inputs/old.toml "$TARGET" ;;
  esac
}

# state JOB: what is there now in one word: nothing, unusable, or a checksum of what it says.
state() {
  [[ -e $TARGET ]] || { echo nothing && return; }
  case $1 in
    convert) cksum <"$TARGET" ;;
    *-csv | *-sigmf)
      iio-angle convert --calibration inputs/old.toml "$TARGET" -o - 2>/dev/null >said &&
        { [[ $1 == record-* || $1 == continue-* ]] && [[ $(wc -l <said) -ge 300 ]] && echo recorded ||
          cksum <said; } || echo unusable ;;
    *) iio-angle convert --calibration "$TARGET" inputs/new.csv -o - 2>/dev/null | cksum ;;
  esac
}

# faulty CALL AT HOW [ON]: the job with one call gone wrong; sets STATUS. Its words are in err.
faulty() {
  STATUS=0
  { FAULT_CALL=$1 FAULT_AT=$2 FAULT_HOW=$3 ${4:+env FAULT_ON=1} \
    env LD_PRELOAD="$SHIM" iio-angle "${COMMAND[@]}" >said 2>err </dev/null || STATUS=$?
  } 2>/dev/null # the shell would tell of each that was killed
}

# calls_of CALL: how many the job makes.
calls_of() {
  rm -f calls
  FAULT_LOG=$PWD/calls LD_PRELOAD="$SHIM" iio-angle "${COMMAND[@]}" >/dev/null 2>&1 </dev/null
  grep -cx "$1" calls || true
}

# places COUNT: which of so many calls are tried: each, but of many the first and last ten.
places() {
  local i
  for ((i = 1; i <= $1; i++)); do
    ((i <= 10 || i > $1 - 10)) && echo "$i"
  done
}
