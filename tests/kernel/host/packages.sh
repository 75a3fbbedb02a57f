# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# What the kernel tests take from Debian: packages that are installed, and packages that are
# only unpacked into the cache (kernel image, kernel source, the iio daemon).

PACKAGES=(qemu-system-x86 busybox-static cpio kmod xz-utils zstd bc gcc make perl
          libiio-utils gpiod udev systemd iproute2)

refuse() {
  printf 'tests/kernel: %s\n' "$*" >&2
  exit 1
}

require_debian() {
  local id version arch
  id=$(. /etc/os-release && echo "${ID:-}") || true
  version=$(. /etc/os-release && echo "${VERSION_ID:-}") || true
  [[ $id == debian && ($version == 12 || $version == 13) ]] ||
    refuse "needs Debian 12 or 13, this is ${id:-unknown} ${version:-}"
  arch=$(dpkg --print-architecture)
  [[ $arch == amd64 ]] || refuse "needs an amd64 machine, this is $arch"
  [[ $(id -u) == 0 ]] || command -v sudo >/dev/null || refuse "needs root, or sudo for apt-get"
}

install_missing() {
  install_packages "$@" >"$WORK/apt.log" 2>&1 ||
    { tail -20 "$WORK/apt.log" >&2; refuse "cannot install $*"; }
}

# Downloads a package into the cache unless it is there; prints the file.
fetch() {
  local package=$1 version=$2 file
  mkdir -p "$CACHE/debs"
  file=$(find "$CACHE/debs" -name "${package}_${version//:/%3a}_*.deb" | head -1)
  if [[ -z $file ]]; then
    (cd "$CACHE/debs" && { apt-get -qq download "$package=$version" ||
      { apt_get update && apt-get -qq download "$package=$version"; } ||
      apt-get -qq download "$package"; }) >"$WORK/fetch.log" 2>&1 ||
      { cat "$WORK/fetch.log" >&2; return 1; }
    file=$(find "$CACHE/debs" -name "${package}_*.deb" -printf '%T@ %p\n' | sort -rn |
      sed -n '1s/[^ ]* //p')
    [[ -n $file ]] || return 1
  fi
  echo "$file"
}
