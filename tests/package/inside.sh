#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# What tests/package/run does inside a chroot, a function a step: inside.sh STEP [ARGUMENT]...
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive

quiet_apt() { apt-get -qq -o Dpkg::Use-Pty=0 "$@"; }

# The packages into /packages, as a repository that apt takes. They are built from the source tarball,
# unpacked elsewhere: it is whole and builds alone.
build() {
  quiet_apt update
  quiet_apt install -y --no-install-recommends ccache
  quiet_apt build-dep -y --no-install-recommends /work
  export CCACHE_DIR=/ccache CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
  cmake -S /work -B /tmp/configured -DADA4571_TESTS=OFF
  cmake --build /tmp/configured --target package_source
  mkdir /tarball
  tar -C /tarball --strip-components=1 -xf /tmp/configured/libada4571-*.tar.gz
  rm -rf /work
  /tarball/tools/package /packages
  cd /packages
  dpkg-scanpackages . >Packages
}

lint() {
  quiet_apt install -y --no-install-recommends lintian
  # As a user: lintian does not like to be root.
  useradd --create-home somebody
  chmod -R a+rX /packages
  su somebody -c 'lintian --info --fail-on error,warning /packages/*.changes'
}

# install PACKAGE, PACKAGE, ...: as debian/tests/control writes it.
install() {
  echo 'deb [trusted=yes] file:/packages ./' >/etc/apt/sources.list.d/packages.list
  quiet_apt update
  local packages=("${@//,/}") index
  for index in "${!packages[@]}"; do
    [[ ${packages[index]} != @ ]] || packages[index]=$(ours)
  done
  # shellcheck disable=SC2068
  quiet_apt install -y --no-install-recommends ${packages[@]}
  useradd --create-home somebody
}

# The names of our packages, all or those that are installed.
ours() { sed -n 's/^Package: //p' /packages/Packages | grep -v -- -dbgsym | tr '\n' ' '; }
ours_installed() {
  local name
  for name in $(ours); do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null) != installed ]] || echo "$name"
  done
}

# As a user without rights, in the tree, with a folder of his own, as autopkgtest does it.
test() {
  mkdir -p /tmp/test
  chown somebody /tmp/test
  su somebody -s /bin/bash -c "cd /tree && AUTOPKGTEST_TMP=/tmp/test bash debian/tests/$1"
}

# Takes the packages away and looks for what they left.
remove() {
  local installed left=0 path
  mapfile -t installed < <(ours_installed)
  [[ ${#installed[@]} != 0 ]] || { echo "nothing was installed"; return 1; }
  dpkg -L "${installed[@]}" | sort -u >/root/paths
  quiet_apt purge -y "${installed[@]}"
  while read -r path; do
    if [[ -e $path ]] && ! dpkg -S "$path" >/dev/null 2>&1; then
      echo "left behind: $path" && left=1
    fi
  done < <(grep '^/[^.]' /root/paths)
  while read -r path; do
    echo "left behind: $path" && left=1
  done < <(find / -xdev \( -name '*ada4571*' -o -name '*iio-angle*' \) \
    -not -path '/packages/*' -not -path '/tree/*' -not -path '/var/cache/apt/*' -not -path '/var/lib/apt/*' \
    -not -path '/tmp/*')
  return $left
}

"$@"
