# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Which tests a port runs, on which processors, and why not all of them. Sourced by run.

# Folders of tests/, in the order in which data flows.
FOLDERS=(acquisition recording import model simulation conversion calibration api cli fuzz)

left_out() {
  cat <<'END'
left out: diagnosis, truth    statistics over many fits and searches: hours under emulation; the
                              comparison with this machine covers diagnose's numbers
left out: of calibration      Wild, EllipseFitBound and is_the_fit_of_all_samples likewise: hundreds of
                              captures each; the comparison covers calibrate's numbers
left out: health, study       likewise: hostile numbers through many searches
left out: report              needs gnuplot and a browser of the processor
left out: kernel, dts, bench  boot a guest, read overlays, measure this machine: no business of a port
left out: by name             IioIiod starts Debian's iiod on devices that umockdev makes; Pins, IioLocal
                              and IioRate put umockdev before the system calls, which qemu-user makes;
                              installed, readme, symbols, shellcheck and completion compile or read
                              what is the same on every processor
END
}
LEFT_OUT='Wild|EllipseFitBound|is_the_fit_of_all_samples|IioIiod|IioLocal|IioRate|PinsTest|api_installed|api_readme|api_symbols|shellcheck|completion'

# Processors to run the vector kernels on, as qemu-user names them: one without SVE, and SVE with
# vectors of 128, 256, 512 and 2048 bits; likewise what Debian expects at least, and more.
kernel_processors() {
  case $ARCH in
    arm64) echo cortex-a72 max,sve-max-vq=1 max,sve-max-vq=2 max,sve-max-vq=16 ;;
    armhf) echo cortex-a8 cortex-a7 ;;
    riscv64) echo rv64,v=false rv64,v=true,vlen=128 ;;
    s390x) echo qemu max ;;
  esac
}

PASSED=0 FAILED=0

# sum JUNIT WHAT: adds the tests of a result file to the sums; without the file one has failed.
sum() {
  local total failed skipped
  if [[ ! -s $1 ]]; then
    echo "FAILED: $2 did not end"
    FAILED=$((FAILED + 1))
    return
  fi
  total=$(grep -c '<testcase ' "$1" || true)
  failed=$(grep -c '<failure' "$1" || true)
  skipped=$(grep -cE '<skipped|status="notrun"' "$1" || true)
  PASSED=$((PASSED + total - failed - skipped))
  FAILED=$((FAILED + failed))
  echo "$2: $((total - failed - skipped)) passed, $failed failed, $skipped skipped"
}

# Foreign programs find their loader and libraries by QEMU_LD_PREFIX; ctest and the scripts are this
# machine's.
run_folder() {
  local junit=$BUILD/$1.xml
  rm -f "$junit"
  in_tools env QEMU_LD_PREFIX="$ROOT" ctest --test-dir "$BUILD/tests/$1" --output-on-failure \
    --timeout 1800 -E "$LEFT_OUT" --output-junit "$junit" >"$BUILD/$1.log" 2>&1 || true
  grep -E '\*\*\*(Failed|Timeout|Exception)|Not Run' "$BUILD/$1.log" || true
  sum "$junit" "$1"
}

# run_program PROGRAM WHAT [OPTIONS]: a gtest program by itself.
run_program() {
  local junit=$BUILD/program.xml program=$1 what=$2
  shift 2
  rm -f "$junit"
  in_tools env QEMU_LD_PREFIX="$ROOT" "$@" "$program" --gtest_brief=1 \
    --gtest_output="xml:$junit" >"$BUILD/program.log" 2>&1 || true
  grep -E ' rad$|FAILED|Failure' "$BUILD/program.log" || true
  sum "$junit" "$what"
}

# The conversion tests on every processor; they print what each instruction set came to.
run_kernels() {
  local cpu
  for cpu in $(kernel_processors); do
    echo "== kernels on $cpu"
    run_program "$BUILD/tests/conversion/conversion_test" "kernels on $cpu" QEMU_CPU="$cpu" \
      GTEST_FILTER='*OnTarget*:*VectorTarget*'
  done
}

# The verbs' numbers beside those of this machine's own build.
compare_numbers() {
  local native=$TOP/build/release/tools/iio-angle
  if [[ ! -x $native ]]; then
    echo "no build/release to compare numbers with: cmake --build --preset release makes it"
    return
  fi
  if QEMU_LD_PREFIX=$ROOT python3 "$HERE/compare.py" "$native" "$BUILD/tools/iio-angle"; then
    PASSED=$((PASSED + 1))
  else
    FAILED=$((FAILED + 1))
  fi
}

run_everything() {
  local folder
  left_out
  for folder in "${FOLDERS[@]}"; do
    run_folder "$folder"
  done
  run_kernels
  compare_numbers
}

run_only() {
  local program path
  for program; do
    path=$(find "$BUILD/tests" -type f -name "$program" -perm -u+x)
    run_program "${path:-$program}" "$program"
  done
}
