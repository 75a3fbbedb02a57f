#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# no_apt.sh SOURCE: no test installs or downloads a package; tests run beside one another, and apt
# has one lock. Only what runs before ctest may, and what ctest never runs.
set -euo pipefail
cd "$1"
ALLOWED='^tests/(run|prepare|no_apt\.sh|kernel/other-release|package/(run|inside\.sh)|port/(run|systems\.sh)):'
WORDS='\b(apt|apt-get|apt-cache|aptitude|apt_get|debootstrap|install_packages|install_named'
WORDS+='|install_where_offered|download_package|apt_offers)\b|dpkg(-deb)? +(-i|--install|--unpack)\b'

# uses_of_apt FILE...: the lines of scripts and programs that say so, comments aside.
uses_of_apt() {
  grep -HnE -- "$WORDS" "$@" | grep -vE '^[^:]*:[0-9]+: *(#|//)' | grep -vE "$ALLOWED" || true
}

mapfile -t files < <(find tests dts -type f -not -name '*.md' | sort)
((${#files[@]} > 100)) || { echo "only ${#files[@]} files found in $1"; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '%s\n' 'apt-get -qq download x' '  install_packages test' 'dpkg -i x.deb' 'sudo apt update' \
  >"$work/bad"
[[ $(uses_of_apt "$work/bad" | wc -l) == 4 ]] || { echo "uses of apt are not seen"; exit 1; }
found=$(uses_of_apt "${files[@]}")
[[ -z $found ]] || { echo "left to tests/prepare, please:" && echo "$found" && exit 1; }
