# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# bash completion for iio-angle. The program itself says what may stand next.

_iio_angle() {
  local line=${COMP_LINE:0:COMP_POINT} words=() current prefix='' breaks='' word
  read -r -a words <<<"$line"
  [[ $line != *' ' ]] || words+=("")
  current=${words[${#words[@]} - 1]}
  # Where bash breaks words at these, it expects only what comes after the last of them.
  [[ $COMP_WORDBREAKS != *:* ]] || breaks+=:
  [[ $COMP_WORDBREAKS != *=* ]] || breaks+='='
  [[ -z $breaks ]] || prefix=${current%"${current##*["$breaks"]}"}
  COMPREPLY=()
  while IFS=$'\t' read -r word _; do
    if [[ $word == :files ]]; then
      compopt -o filenames 2>/dev/null
      mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "${current#--*=}")
    else
      [[ $word != *[=:] ]] || compopt -o nospace 2>/dev/null
      COMPREPLY+=("${word#"$prefix"}")
    fi
  done < <("${words[0]}" complete -- "${words[@]:1}" 2>/dev/null)
}

complete -F _iio_angle iio-angle
