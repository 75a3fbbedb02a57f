# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# Which kernel of this release the tests take, and whether they can: for tests/prepare, which
# downloads it, and for tests/kernel/run, which boots it.

# Prints the reason when they cannot.
kernel_tests_are_possible() {
  local id version arch
  id=$(. /etc/os-release && echo "${ID:-}") || true
  version=$(. /etc/os-release && echo "${VERSION_ID:-}") || true
  [[ $id == debian && ($version == 12 || $version == 13) ]] ||
    { echo "they need Debian 12 or 13, this is ${id:-unknown} ${version:-}" && return 1; }
  arch=$(dpkg --print-architecture)
  [[ $arch == amd64 ]] || { echo "they need an amd64 machine, this is $arch" && return 1; }
}

headers_of() {
  echo "linux-headers-${1:+$1-}amd64"
}

# The header package decides the version: modules have to fit it. $1: "" for the release's own
# kernel, or a series such as 6.12.
find_kernel() {
  KERNEL_VERSION=$(dpkg-query -W -f '${Depends}' "$(headers_of "$1")" 2>/dev/null |
    sed -n 's/.*linux-headers-\([^ ]*-amd64\).*/\1/p')
  [[ -n $KERNEL_VERSION && -d /usr/src/linux-headers-$KERNEL_VERSION ]] ||
    { echo "no kernel headers of $(headers_of "$1"): run tests/prepare" >&2 && return 1; }
  KERNEL_PACKAGE_VERSION=$(dpkg-query -W -f '${Version}' "linux-headers-$KERNEL_VERSION")
  KERNEL_SERIES=$(echo "$KERNEL_VERSION" | cut -d. -f1,2)
}

# unpack_source DEB FOLDER PATTERN...: only the files that are wanted; the whole tree is over a
# gigabyte. tar complains of a pattern that nothing matches: who needs a file looks for it.
unpack_source() {
  local deb=$1 folder=$2 tarball
  tarball=$(dpkg-deb --fsys-tarfile "$deb" | tar -t | grep -o 'linux-source.*\.tar\.xz$' | head -1)
  rm -rf "$folder"
  mkdir -p "$folder"
  dpkg-deb --fsys-tarfile "$deb" | tar -xO "./usr/src/$tarball" | xz -dc -T0 |
    tar -x -C "$folder" --strip-components=1 --wildcards "${@:3}" 2>/dev/null || true
}
