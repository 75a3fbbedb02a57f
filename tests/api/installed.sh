#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# installed.sh BUILD: installs into a folder of its own, and builds and runs a foreign program
# against what is there, by pkg-config and by CMake.
set -euo pipefail
build=$1
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

DESTDIR=$work/staged cmake --install "$build" >"$work/install.log"
# The tree was configured for another place: that it works here shows that it can be moved.
prefix=$work/staged$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")
library=$(dirname "$(find "$prefix" -name libada4571.so)")
export LD_LIBRARY_PATH=$library

for file in bin/iio-angle include/ada4571.h share/man/man1/iio-angle.1 \
  share/bash-completion/completions/iio-angle; do
  [[ -e $prefix/$file ]] || { echo "not installed: $file"; exit 1; }
done
[[ $(find "$prefix/include" -type f | wc -l) == 1 ]] || { echo "more than one header"; exit 1; }
"$prefix/bin/iio-angle" --version

export PKG_CONFIG_PATH=$library/pkgconfig
[[ $(pkg-config --modversion libada4571) == 1.0.0 ]]
# shellcheck disable=SC2046
cc -std=c99 -pedantic-errors -Wall -Werror $(pkg-config --cflags libada4571) \
  "$here/consumer/consumer.c" -o "$work/by-pkg-config" $(pkg-config --libs libada4571)
first=$("$work/by-pkg-config")

cmake -G Ninja -S "$here/consumer" -B "$work/by-cmake" -DCMAKE_PREFIX_PATH="$prefix" >"$work/cmake.log"
cmake --build "$work/by-cmake" >>"$work/cmake.log"
second=$("$work/by-cmake/consumer")
[[ $first == "$second" ]] || { echo "two builds, two results: $first, $second"; exit 1; }
echo "installed, built twice, both say $first deg"
