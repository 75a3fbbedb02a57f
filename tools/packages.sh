# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# What Debian 12 and 13 call the things that the project needs; README.md says what each is for.
# Sourced by tools/demo and tests/run.
# shellcheck disable=SC2034

BUILD_PACKAGES=(g++ cmake ninja-build pkgconf libiio-dev libgpiod-dev libeigen3-dev libhwy-dev
                libcli11-dev libfmt-dev libtomlplusplus-dev nlohmann-json3-dev zlib1g-dev)
REPORT_PACKAGES=(gnuplot-nox chromium)
TEST_PACKAGES=(libgtest-dev libbenchmark-dev libsleef-dev libumockdev-dev umockdev libiio-utils
               iiod device-tree-compiler python3 shellcheck)

as_root() {
  if [[ $(id -u) == 0 ]]; then "$@"; else sudo "$@"; fi
}

apt_get() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 "$@" </dev/null
}

# Installs those of the packages that are missing; fetches the package lists only when it must.
install_packages() {
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

# configure PRESET [OPTIONS]: through ccache where there is one.
configure() {
  if command -v ccache >/dev/null; then
    export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
  fi
  cmake --log-level=WARNING --preset "$@"
}
