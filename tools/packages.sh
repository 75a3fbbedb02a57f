# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# What Debian 12 and 13 call the things that the project needs; README.md says what each is for.
# Sourced by tools/demo, tools/package, tests/run and tests/prepare: nothing else installs or
# downloads, but for what does so in a chroot.

# checksum_package ARCHITECTURE: what the build takes checksums from there.
checksum_package() {
  case $1 in
    amd64 | arm64) echo libisal-dev ;;
    *) echo libdeflate-dev ;;
  esac
}

# What is needed for what: a new package goes here and nowhere else. `kernel` is for the tests that
# boot a kernel or read its source; `where-offered` is not in every release (Debian 13 has no
# dt-schema), and what needs it is skipped there.
declare -A PACKAGES=(
  [build]="g++ cmake ninja-build pkgconf libiio-dev libgpiod-dev libeigen3-dev libhwy-dev
    libcli11-dev $(checksum_package "$(dpkg --print-architecture)") libfmt-dev libncurses-dev libtomlplusplus-dev nlohmann-json3-dev
    zlib1g-dev libsqlite3-dev libboost-dev python3"
  [python]="pybind11-dev python3-dev python3-numpy"
  [docs]="doxygen mandoc mkdocs device-tree-compiler"
  [report]="gnuplot-nox"
  [test]="libgtest-dev libbenchmark-dev libsleef-dev libumockdev-dev umockdev libiio-utils iiod
    device-tree-compiler mandoc python3-pytest shellcheck chromium
    poppler-utils slurmctld slurmd slurm-client munge sqlite3
    python3-pandas libsystemd-dev tmux zsh fish"
  [kernel]="qemu-system-x86 busybox-static cpio kmod xz-utils zstd bc gcc make perl gpiod udev
    systemd iproute2"
  [where-offered]="dt-schema"
  [other-release]="debootstrap"
  [package]="build-essential dpkg-dev"
  [port]="debootstrap qemu-user-static"
)

# Downloads that are only unpacked, and what is made of them.
KERNEL_CACHE=${ADA4571_CACHE:-${XDG_CACHE_HOME:-${HOME:-/var/cache}/.cache}/ada4571-kernel}

as_root() {
  if [[ $(id -u) == 0 ]]; then "$@"; else sudo "$@"; fi
}

apt_get() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 "$@" </dev/null
}

# install_packages GROUP...: those of the table's packages that are missing.
install_packages() {
  local group names=()
  for group; do
    read -r -d '' -a names <<<"${names[*]} ${PACKAGES[$group]}" || true
  done
  install_named "${names[@]}"
}

# Fetches the package lists only when it must.
install_named() {
  local missing=() package
  for package; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
      missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  echo "installing: ${missing[*]}"
  apt_get install -y --no-install-recommends "${missing[@]}" >/dev/null 2>&1 ||
    { apt_get update >&2 && apt_get install -y --no-install-recommends "${missing[@]}" >&2; } ||
    { echo "cannot install ${missing[*]}: are you root, or is sudo there?" >&2; return 1; }
}

# install_where_offered GROUP: those that this release has; says which it has not.
install_where_offered() {
  local package
  for package in ${PACKAGES[$1]}; do
    if [[ -n $(apt_offers "$package") ]]; then
      install_named "$package"
    else
      echo "not in this release: $package; the checks that need it are skipped"
    fi
  done
}

# downloaded PACKAGE VERSION: prints the file in the cache; fails when it is not there.
downloaded() {
  local file
  file=$(find "$KERNEL_CACHE/debs" -name "$1_${2//:/%3a}_*.deb" 2>/dev/null | head -1)
  [[ -n $file ]] && echo "$file"
}

# download_package PACKAGE VERSION: into the cache, unless it is there.
download_package() {
  ! downloaded "$@" >/dev/null || return 0
  echo "downloading: $1 $2"
  mkdir -p "$KERNEL_CACHE/debs"
  in_debs() { (cd "$KERNEL_CACHE/debs" && "$@"); }
  in_debs apt-get -qq download "$1=$2" >/dev/null 2>&1 ||
    { apt_get update >&2 && in_debs apt-get -qq download "$1=$2" >&2; } ||
    { echo "cannot download $1 $2" >&2; return 1; }
}

# The version that would be installed; nothing when the release does not offer the package.
apt_offers() {
  apt-cache policy "$1" 2>/dev/null | awk '/Candidate:/ && $2 != "(none)" {print $2}'
}

# configure PRESET [OPTIONS]: through ccache where there is one.
configure() {
  if command -v ccache >/dev/null; then
    export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
  fi
  cmake --log-level=WARNING --preset "$@"
}
