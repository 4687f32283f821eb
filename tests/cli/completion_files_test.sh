#!/usr/bin/env bash
# completion_files_test.sh PROGRAM FISH_FILE ZSH_FILE MAN_PAGE: every command and every option of every --help stands in
# the completions and in the manual page, its term in one piece; the shells that are installed are asked what they offer.
set -uo pipefail
program=$1 fish_file=$2 zsh_file=$3 page=$4
failures=0 listed=0
fail() { echo "$*"; failures=$((failures + 1)); }

commands_of() { "$program" "$@" --help | awk '/^Subcommands:/ {inside = 1; next} /^[^ ]/ {inside = 0} inside && /^  [a-z]/ {print $1}'; }
options_of() { "$program" "$@" --help | grep -oE -- '^  -[^ ]+' | tr -d ' ' | tr ',' '\n'; }

has_fish=$(command -v fish) || echo "fish is not installed: its completion is read, not asked"
has_zsh=$(command -v zsh) || echo "zsh is not installed: its completion is read, not asked"

in_fish() {  # what fish offers for a line
  HOME=${TMPDIR:-/tmp} PATH=$(dirname "$program"):$PATH fish --no-config -c "source $fish_file; complete -C '$1'" 2>&1 | cut -f 1
}
# What the function hands to zsh's own for these words, a line each.
in_zsh() {
  zsh --no-rcs -c '
    compdef() { }
    _arguments() { print -rl -- "$@" | sed -E "s/=?\[.*//" }
    _describe() { print -rl -- "${commands[@]}" | sed "s/:.*//" }
    source $1; shift
    words=(xrds "$@"); CURRENT=$#words
    _xrds' zsh "$zsh_file" "$@" 2>&1
}

expect() {  # expect WORD OFFERED WHO LINE
  grep -qxF -- "$1" <<< "$2" || fail "$3 should offer '$1' for '$4'"
  listed=$((listed + 1))
}

look_at() {  # look_at VERB...: the options and commands below
  local word offered_fish='' offered_zsh=''
  local section="XRDS${*:+ ${*^^}}"
  local text
  text=$(awk -v section=".SH $section" '/^\.SH/ {inside = toupper($0) == section} inside' "$page" | sed 's/\\-/-/g')
  [ -z "$has_fish" ] || offered_fish=$(in_fish "xrds${*:+ $*} -")
  [ -z "$has_zsh" ] || offered_zsh=$(in_zsh "$@" -)
  for word in $(options_of "$@"); do
    grep -qE -- "(^|[ ,\\B])$word([ ,\\]|$)" <<< "${text//\\fB/ }" || fail "The manual page has no $word of 'xrds $*'"
    [ -z "$has_fish" ] || expect "$word" "$offered_fish" fish "xrds $* -"
    [ -z "$has_zsh" ] || expect "$word" "$offered_zsh" zsh "xrds $* -"
    grep -qF -- "${word##*-}" "$fish_file" || fail "$fish_file has no $word"
    grep -qF -- "'$word" "$zsh_file" || fail "$zsh_file has no $word"
  done
  [ -z "$has_fish" ] || offered_fish=$(in_fish "xrds${*:+ $*} ")
  [ -z "$has_zsh" ] || offered_zsh=$(in_zsh "$@" '')
  for word in $(commands_of "$@"); do
    [ -z "$has_fish" ] || expect "$word" "$offered_fish" fish "xrds $* "
    [ -z "$has_zsh" ] || expect "$word" "$offered_zsh" zsh "xrds $* "
    "$program" "$@" "$word" --help > /dev/null 2>&1 && look_at "$@" "$word"
  done
}
look_at
broken=$(grep -E "'-[^[]*\[-" "$zsh_file")  # '--one[--another Its description]'
[ -z "$broken" ] || fail "A part of a term begins a description: $broken"
broken=$(grep -oE "'--[^[]*\[.*\]:[^:]*:\([^)]*[ (,][,)].*" "$zsh_file")  # a word that nothing takes: (all,)
[ -z "$broken" ] || fail "What is offered is no word: $broken"
broken=$(grep -E '(Needs|Excludes):\\fR$' "$page")
[ -z "$broken" ] || fail "The manual page has but a part of a term: $broken"

if [ -n "$has_fish" ]; then
  expect fp16 "$(in_fish 'xrds upscale --precision ')" fish '--precision'
  expect safe "$(in_fish 'xrds upscale --skip ')" fish '--skip'
  expect all "$(in_fish 'xrds upscale --layers ')" fish '--layers'
  [ -z "$(in_fish 'xrds view --samples ')" ] || fail "fish should offer nothing for '--samples N|LOW,HIGH'"
  expect xrds-x4-nano "$(in_fish 'xrds info x')" fish 'info x'
  [ -z "$(in_fish 'xrds devices ')" ] || fail "fish should offer nothing for 'xrds devices '"
fi
[ "$failures" -eq 0 ] && echo "$listed words are offered"
exit $((failures > 0))
