# Bash completion for xrds: source it, or install it as share/bash-completion/completions/xrds.
# Commands, options and the words that options take are read from --help, models from `xrds info`: nothing to keep in step.
_xrds_help() { "${COMP_WORDS[0]}" "$@" --help 2>/dev/null; }

_xrds_commands() { _xrds_help "$@" | awk '/^Subcommands:/ {inside = 1; next} /^[^ ]/ {inside = 0} inside && /^  [a-z]/ {print $1}'; }

_xrds_options() { _xrds_help "$@" | grep -oE -- '^  -[^ ]+' | tr ', ' '\n'; }

# What stands between an option's name and its description, which begins in column 31 or on the next line:
# "TEXT:{fp32,fp16}=fp32", "TEXT:off|safe|N=off", "PNG", or nothing.
_xrds_type() {
  local option=$1
  shift
  _xrds_help "$@" | awk -v option="$option" '
    /^  -/ {
      split($1, names, ",")
      for (i in names) if (names[i] == option) { print ($2 == "" || index($0, $2) > 30) ? "" : $2; exit }
    }'
}

# The words that an option of this type takes, one a line.
_xrds_words() {
  case $1 in
    *{*}*) sed 's/.*{//; s/}.*//; s/,/\n/g' <<< "$1" ;;
    *\|*) sed 's/=.*//; s/.*://; s/|/\n/g' <<< "$1" | grep -E '^[a-z]+$' ;;
    MODEL*) "${COMP_WORDS[0]}" info 2>/dev/null ;;
    SCENE*) printf '%s\n' room garden spheres ;;
  esac
}

_xrds_complete() { mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen "$@"); }

_xrds() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} verbs=() at=1 type listed=
  COMPREPLY=()
  [ "$COMP_CWORD" -gt 1 ] && verbs=("${COMP_WORDS[1]}") at=2
  if [[ ${COMP_WORDS[1]} = bench || ${COMP_WORDS[1]} = import ]] && [ "$COMP_CWORD" -gt 2 ]; then
    verbs+=("${COMP_WORDS[2]}") at=3
  fi
  if [ "$COMP_CWORD" -eq "$at" ]; then
    local commands
    commands=$(_xrds_commands "${verbs[@]}")
    if [ -n "$commands" ]; then
      _xrds_complete -W "$commands $(_xrds_options "${verbs[@]}")" -- "$current"
      return
    fi
  fi
  if [[ $previous == -* ]] && [ "$COMP_CWORD" -gt "$at" ]; then
    type=$(_xrds_type "$previous" "${verbs[@]}")
    if [ -n "$type" ]; then
      [[ $type == *{* && $current == *,* ]] && listed=${current%,*},
      _xrds_complete -P "$listed" -W "$(_xrds_words "$type")" -- "${current#"$listed"}"
      [[ $type =~ EXR|PNG|JSON|MD|FILE|FOLDER|MODEL|SCENE ]] && _xrds_complete -f -- "$current"
      return
    fi
  fi
  if [[ $current == -* ]]; then
    _xrds_complete -W "$(_xrds_options "${verbs[@]}")" -- "$current"
  else
    [[ ${verbs[0]} = info || ${verbs[0]} = tune ]] && _xrds_complete -W "$("${COMP_WORDS[0]}" info 2>/dev/null)" -- "$current"
    [ "${verbs[0]}" = devices ] || _xrds_complete -f -- "$current"
  fi
}
complete -o filenames -F _xrds xrds
