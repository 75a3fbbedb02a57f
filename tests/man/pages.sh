#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# pages.sh BUILD: every page is clean to mandoc's lint, every verb and function has one, and every
# option that a verb takes stands on its page.
set -euo pipefail
build=$1
pages=$build/tools/man/pages
iio_angle=$build/tools/iio-angle
failed=

complain() {
  echo "$*"
  failed=1
}

mapfile -t files < <(find "$pages" -name '*.[135]' -type f)
((${#files[@]} > 20)) || complain "only ${#files[@]} pages in $pages"
# Lint that sees nothing would not see this either.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
{ cat "${files[0]}" && echo '.WRONG'; } >"$work/wrong.1"
! mandoc -T lint "$work/wrong.1" >/dev/null || complain "mandoc does not see a macro that is none"
mandoc -T lint "${files[@]}" || complain "pages are not clean"

# words VERB...: the long options of its --help, but for --help itself.
words() {
  "$iio_angle" "$@" --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+' |
    grep -vxE -- '--(help|version)' || true
}

# verbs [VERB]: the subcommands that --help lists.
verbs() {
  "$iio_angle" "$@" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p'
}

count=0
for verb in $(verbs); do
  page=$pages/man1/iio-angle-$verb.1
  [[ -e $page ]] || { complain "no page for $verb" && continue; }
  said=$(mandoc -T utf8 "$page" | sed 's/.\x08//g')
  for part in "" $(verbs "$verb"); do
    for word in $(words "$verb" ${part:+"$part"}); do
      count=$((count + 1))
      grep -qE -- "(^|[ ,])$word( |,|\$)" <<<"$said" || complain "$page lacks $word"
    done
  done
done
((count > 40)) || complain "only $count options found"

while read -r function; do
  [[ -e $pages/man3/$function.3 ]] || complain "no page for $function"
done < <(sed -n 's/^    \(ada4571_[a-z0-9_]*\);$/\1/p' "$(dirname "$0")/../../lib/libada4571.map")

# What is installed points to what is installed: to pages that there are, and to no file of the source.
source=$(cd "$(dirname "$0")/../.." && pwd)
texts=("${files[@]}" "$source/lib/include/ada4571.h" "$source"/udev/*.service "$source"/udev/*.rules
  "$source"/tools/examples/*.c "$source/dts/README.md" "$source/udev/README.md")
for text in "${texts[@]}"; do
  ! grep -HnE '\b(docs|udev|tests|lib|dts|build|tools)/[A-Za-z0-9_/-]*|[A-Za-z0-9_-]+\.md\b' "$text" |
    grep -vE '/(lib|dts|etc/udev)/|/share/doc/' || complain "$text points into the source tree"
done
references=$(sed 's/\\-/-/g; s/\\f[A-Z]//g' "${texts[@]}" |
  grep -oE '\b(lib|iio-angle|ada4571)[a-z0-9_-]*\([135]\)' | sort -u)
(($(wc -l <<<"$references") > 5)) || complain "only these references found: $references"
while IFS='()' read -r page section _; do
  [[ -e $pages/man$section/$page.$section ]] || complain "there is no $page($section)"
done <<<"$references"

[[ -z $failed ]]
echo "${#files[@]} pages, $count options"
