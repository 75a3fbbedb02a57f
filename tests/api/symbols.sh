#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# symbols.sh HEADER MAP LIBRARY: the functions of the header, of the version script and of the
# library's dynamic symbols are the same, and the library needs no more than it says.
set -euo pipefail
header=$1 map=$2 library=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

perl -0ne 'print "$1\n" while /ADA4571_API\b[^;(]*?\b(ada4571_\w+)\s*\(/g' "$header" |
  sort >"$work/header"
grep -oE '\bada4571_[a-z0-9_]+\b' "$map" | sort >"$work/map"
nm -D --defined-only "$library" | awk '$2 != "A" { print $3 }' >"$work/exported"
sed 's/@.*//' "$work/exported" | sort >"$work/library"

same() {
  diff --label "$3" --label "$4" "$1" "$2" || { echo "$3 and $4 differ"; status=1; }
}
same "$work/header" "$work/map" "functions of ada4571.h" "functions of libada4571.map"
same "$work/header" "$work/library" "functions of ada4571.h" "symbols of the library"
if grep -v '@@ADA4571_[0-9.]*$' "$work/exported"; then
  echo "these symbols have no version"
  status=1
fi
[[ -s $work/header ]] || { echo "no function found in $header"; status=1; }
soname=$(objdump -p "$library" | awk '$1 == "SONAME" { print $2 }')
[[ $soname == libada4571.so.1 ]] || { echo "the SONAME is $soname"; status=1; }
exit $status
