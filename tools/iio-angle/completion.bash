# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# bash completion for iio-angle. Verbs and options are asked from the program's own --help, so that
# they cannot differ from it.

_iio_angle() {
  local current=${COMP_WORDS[COMP_CWORD]} verb=() word
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case $word in
      -*) break ;;
      list | record | read | watch | calibrate | convert | simulate | emulate | diagnose | check | \
        pins | catalogue | figures | study) [[ ${#verb[@]} != 0 ]] || verb=("$word") ;;
      single | dual) [[ ${verb[*]} != calibrate ]] || verb+=("$word") ;;
      run | merge | report) [[ ${verb[*]} != study ]] || verb+=("$word") ;;
      *) break ;;
    esac
  done
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" "${verb[@]}" --help 2>/dev/null |
      grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+')" -- "$current")
  elif [[ ${#verb[@]} == 0 || ${verb[*]} == calibrate || ${verb[*]} == study ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" "${verb[@]}" --help 2>/dev/null |
      sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')" -- "$current")
  elif [[ ${verb[*]} == pins ]]; then
    mapfile -t COMPREPLY < <(compgen -W "gc pd on off" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}

complete -o filenames -F _iio_angle iio-angle
