# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# The systems that a port needs: the foreign one that holds libraries and headers, the one that holds
# compilers of the same release, and the emulator that runs what was built. Sourced by run.

# What programs and tests are linked with, and the foreign programs that tests start.
FOREIGN_PACKAGES=(libiio-dev libgpiod-dev libeigen3-dev libhwy-dev libcli11-dev libfmt-dev
                  "$(checksum_package "$ARCH")" libtomlplusplus-dev nlohmann-json3-dev zlib1g-dev libsqlite3-dev
                  libboost-dev libncurses-dev libgtest-dev libumockdev-dev)
# From libiio-utils on: what tests start.
TOOL_PACKAGES=("g++-$TRIPLET" cmake ninja-build pkgconf device-tree-compiler python3 binutils
               libiio-utils gnuplot-nox tmux sqlite3 procps python3-numpy)

comma() {
  local IFS=,
  echo "$*"
}

# is_made WHAT PACKAGE...: whether that system was made with just these packages; `note_made` says
# that it was. One that was made for an older tree lacks what this one needs.
is_made() {
  [[ -e $1.done && $(<"$1.done") == "${*:2}" ]]
}
note_made() {
  echo "${*:2}" >"$1.done"
}

# A foreign Debian whose packages are unpacked and not configured: its libraries are linked with and
# loaded, none of its services runs, and so nothing of it has to be emulated here.
make_foreign_system() {
  ! is_made "$ROOT" "${FOREIGN_PACKAGES[@]}" || return 0
  echo "== making Debian $SUITE for $ARCH in $ROOT"
  rm -rf "$ROOT"
  mkdir -p "$CACHE"
  debootstrap --foreign --arch="$ARCH" --variant=minbase \
    --include="$(comma "${FOREIGN_PACKAGES[@]}")" "$SUITE" "$ROOT" "$MIRROR" >"$ROOT.log" 2>&1 ||
    { tail -5 "$ROOT.log" >&2 && refuse "cannot make a Debian $SUITE for $ARCH"; }
  local package
  for package in "$ROOT"/var/cache/apt/archives/*.deb; do
    dpkg-deb -x "$package" "$ROOT"
  done
  make_links_relative
  note_made "$ROOT" "${FOREIGN_PACKAGES[@]}"
}

# An absolute link means another file for who looks at the system from outside.
make_links_relative() {
  local link target
  while IFS= read -r -d '' link; do
    target=$(readlink "$link")
    ln -sfnr "$ROOT$target" "$link"
  done < <(find "$ROOT/usr/lib" "$ROOT/lib/$TRIPLET" -xdev -type l -lname '/*' -print0)
}

# The release's own compiler: this system's where it is the same release, else one in a folder.
choose_tools() {
  TOOLS=$CACHE/tools-$SUITE
  [[ $(. /etc/os-release && echo "${VERSION_CODENAME:-}") != "$SUITE" ]] || TOOLS=
}

make_tools() {
  if [[ -z $TOOLS ]]; then
    install_named "${TOOL_PACKAGES[@]}"
    return
  fi
  ! is_made "$TOOLS.$ARCH" "${TOOL_PACKAGES[@]}" || return 0
  echo "== making a Debian $SUITE for the compiler in $TOOLS"
  [[ -e $TOOLS/etc/debian_version ]] ||
    debootstrap --variant=minbase "$SUITE" "$TOOLS" "$MIRROR" >"$TOOLS.log" 2>&1 ||
    { tail -5 "$TOOLS.log" >&2 && refuse "cannot make a Debian $SUITE"; }
  cp /etc/resolv.conf "$TOOLS/etc/resolv.conf"
  DEBIAN_FRONTEND=noninteractive chroot "$TOOLS" apt-get -qq install -y --no-install-recommends \
    "${TOOL_PACKAGES[@]}" >>"$TOOLS.log" 2>&1 </dev/null ||
    { tail -5 "$TOOLS.log" >&2 && refuse "cannot install g++-$TRIPLET"; }
  note_made "$TOOLS.$ARCH" "${TOOL_PACKAGES[@]}"
}

is_prepared() {
  is_made "$ROOT" "${FOREIGN_PACKAGES[@]}" && [[ -e /proc/sys/fs/binfmt_misc/qemu-$QEMU ]] &&
    if [[ -n $TOOLS ]]; then
      is_made "$TOOLS.$ARCH" "${TOOL_PACKAGES[@]}"
    else
      command -v "$TRIPLET-g++" >/dev/null
    fi
}

# Runs a command beside the compilers, where source, build and foreign system have the same paths.
in_tools() {
  local clean=(env PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8)
  if [[ -z $TOOLS ]]; then
    (cd "$TOP" && "${clean[@]}" "$@" </dev/null)
    return
  fi
  # shellcheck disable=SC2016
  TOP=$TOP TOOLS=$TOOLS unshare --mount --pid --fork --kill-child bash -euc '
    for folder in "$TOP" "$ROOT"; do
      mkdir -p "$TOOLS$folder"
      mount --rbind "$folder" "$TOOLS$folder"
    done
    mount -t proc proc "$TOOLS/proc"
    mount --rbind /dev "$TOOLS/dev" # with its pseudo-terminals
    mount -t tmpfs tmpfs "$TOOLS/tmp"
    exec chroot "$TOOLS" /bin/sh -c "cd \"\$0\" && exec \"\$@\"" "$TOP" "$@" </dev/null' \
    in_tools "${clean[@]}" "$@"
}

# The kernel starts foreign programs through qemu-user; F: it opens the emulator now, so that it is
# found from within every root.
register_emulator() {
  local folder=/proc/sys/fs/binfmt_misc line
  [[ -e $folder/register ]] || mount -t binfmt_misc binfmt_misc "$folder" ||
    refuse "this kernel has no binfmt_misc"
  if [[ ! -e $folder/qemu-$QEMU ]]; then
    line=$(grep -h "^:qemu-$QEMU:" /usr/lib/binfmt.d/*.conf | head -1)
    [[ $line == *F* ]] || refuse "qemu-user-static does not say how to register qemu-$QEMU"
    printf '%s' "$line" >"$folder/register"
  fi
  grep -q '^flags:.*F' "$folder/qemu-$QEMU" || refuse "qemu-$QEMU is registered without the flag F"
}
