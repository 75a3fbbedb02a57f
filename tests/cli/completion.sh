#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# completion.sh BUILD FOLDER [PATTERN]: what bash, zsh and fish offer after the words typed so far,
# by the completions in FOLDER. A shell that is not installed is left out.
set -u
BUILD=$(cd "$1" && pwd)
FOLDER=$(realpath "$2")
PATH=$BUILD/tools:$PATH
# shellcheck source=tests/cli/words.sh
. "$(dirname "$0")/words.sh"
# shellcheck source=/dev/null
. "$FOLDER/iio-angle.bash"
# Names that `list --save` would have stored.
XDG_CONFIG_HOME=$(mktemp -d)
export XDG_CONFIG_HOME
trap 'rm -rf "$XDG_CONFIG_HOME"' EXIT
mkdir "$XDG_CONFIG_HOME/ada4571"
touch "$XDG_CONFIG_HOME/ada4571/wheel.toml" "$XDG_CONFIG_HOME/ada4571/no name.toml"

# in_SHELL LINE: the words that the shell offers at the end of the line, without their explanations.
in_bash() {
  COMP_LINE=$1 COMP_POINT=${#1} COMP_WORDBREAKS=$' \t\n"\'><=;|&(:'
  COMPREPLY=()
  _iio_angle
  # bash replaces what comes after the last break only.
  local typed=${1##* } reply
  for reply in "${COMPREPLY[@]}"; do
    printf '%s\n' "${typed%"${typed##*[:=]}"}$reply"
  done
}

# The functions of zsh's completion system that the file calls, as far as it uses them.
in_zsh() {
  zsh -f -c '
    _describe() {
      [[ $1 == -o ]] && shift
      local entry
      for entry in "${(@P)2}"; do
        entry=${entry//\\:/$'"'\\0'"'}
        print -r -- "${${entry%%:*}//$'"'\\0'"'/:}"
      done
    }
    compset() { :; }
    _files() { print -rl -- ${(Q)words[CURRENT]}*(N); }
    words=(${(z)1}) CURRENT=${#words}
    [[ $1 == *" " ]] && { words+=(""); (( ++CURRENT )); }
    complete_it() { source $2; }
    complete_it "$@"' zsh "$1" "$FOLDER/_iio-angle"
}

# The line that zsh itself makes of LINE when Tab is pressed, with its own completion system, which
# has a will of its own: it offers what is called an option only after a dash.
completed_by_zsh() {
  zsh -f -c '
    zmodload zsh/zpty
    zpty shell zsh -f -i
    zpty -w shell "fpath=(${(q)2} \$fpath); autoload -U compinit; compinit -u -D"
    zpty -w shell "line() { print -r -- \"<\"\"<\$BUFFER>>\"; }; zle -N line; bindkey ^G line; print READ\"\"Y"
    zpty -r -m shell out "*READY*"
    zpty -w -n shell "$1"$'"'\t\a'"'
    zpty -r -m shell out "*<<*>>*"
    out=${out##*<<}
    print -r -- "${out%%>>*}"
    zpty -d shell' zsh "$1" "$FOLDER"
}

in_fish() {
  fish --no-config -c "source $FOLDER/iio-angle.fish; complete -C '$1'" | cut -f1
}

SHELLS=(bash)
for shell in zsh fish; do
  if command -v "$shell" >/dev/null; then
    SHELLS+=("$shell")
  else
    echo "skipped: $shell is not installed"
  fi
done

# offers LINE WORD...: these words and no others, in every shell.
offers() {
  local line=$1 shell
  shift
  for shell in "${SHELLS[@]}"; do
    same "after '$line' in $shell" "$("in_$shell" "$line" | sort -u | xargs)" \
      "$(printf '%s\n' "$@" | sort -u | xargs)"
  done
}

# offers_among LINE WORD...: these words among others.
offers_among() {
  local line=$1 shell word
  shift
  for shell in "${SHELLS[@]}"; do
    "in_$shell" "$line" >offered
    for word; do
      grep -qxF -e "$word" offered || fail "'$word' is not offered after '$line' in $shell"
    done
  done
}

check_verbs_and_options() {
  offers "iio-angle cal" calibrate
  offers "iio-angle calibrate " single dual
  offers "iio-angle help cal" calibrate
  offers "iio-angle record --dur" --duration
  offers "iio-angle calibrate single --m" --method
  local verbs
  mapfile -t verbs < <(iio-angle --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
  ((${#verbs[@]} > 10)) || fail "only ${#verbs[@]} verbs in --help"
  offers "iio-angle " "${verbs[@]}"
  local verb
  for verb in "${verbs[@]}"; do
    offers_among "iio-angle $verb --h" --help
  done
}

check_values() {
  offers "iio-angle read --format " text csv json
  offers "iio-angle read --format=c" --format=csv
  offers "iio-angle convert --format " csv sigmf
  offers "iio-angle import --separator " bar blank comma semicolon tab
  offers "iio-angle calibrate single --method e" extrema
  offers "iio-angle pins " gc pd
  offers "iio-angle pins gc o" on off
  offers "iio-angle pins gc on " # nothing comes after it
  offers "iio-angle read -s " wheel
  offers "iio-angle list --stored wh" wheel
  offers "iio-angle simulate --effect channel-sk" channel-skew
  offers "iio-angle simulate --effect channel-skew:d" channel-skew:dt_s=
  offers "iio-angle simulate --effect stray-field:b=1,d" stray-field:b=1,direction_deg=
  offers_among "iio-angle simulate --motion " constant:rpm=600
  offers "iio-angle simulate --temperature cy" cycle:from=0,to=80
  offers "iio-angle figures mis" mismatch
  offers "iio-angle catalogue channel-sk" channel-skew
}

check_every_effect() {
  local effects
  mapfile -t effects < <(iio-angle catalogue | sed -n 's/^\([a-z-]*\)  (.*/\1/p')
  ((${#effects[@]} >= 20)) || fail "only ${#effects[@]} effects in the catalogue"
  offers "iio-angle simulate --effect " "${effects[@]}"
}

check_files() {
  touch capture.csv "two words.csv"
  offers "iio-angle check cap" capture.csv
  offers "iio-angle check --calibration cap" capture.csv
  offers "iio-angle diagnose --json capture.csv cap" capture.csv
  offers "iio-angle emulate cap" # takes none
}

check_zsh_takes_what_it_is_offered() {
  command -v zsh >/dev/null || return 0
  local line
  for line in "iio-angle pins g:iio-angle pins gc " "iio-angle read --form:iio-angle read --format " \
    "iio-angle figures mis:iio-angle figures mismatch " "iio-angle diagn:iio-angle diagnose "; do
    same "Tab after '${line%:*}'" "$(completed_by_zsh "${line%:*}")" "${line#*:}"
  done
  same "Tab after a parameter" "$(completed_by_zsh "iio-angle simulate --effect channel-skew:d")" \
    "iio-angle simulate --effect channel-skew:dt_s="
}

run_checks "${3:-}"
