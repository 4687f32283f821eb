#!/usr/bin/env bash
# completion.sh PROGRAM fish|zsh|table: writes the completion of xrds from the --help of the program and of its commands.
# table: what the others are made of. Every command, positional and option is a line, with tabs between:
# command PATH NAME DESCRIPTION; positional PATH NAME DESCRIPTION; option PATH NAMES TYPE DESCRIPTION. PATH is as "bench quality".
set -euo pipefail
program=$1
shell=$2
here=$(dirname "$0")

page() { "$program" "$@" --help | awk -v path="$*" -f "$here/help_to_table.awk"; }

commands() { cut -f 1,3 <<< "$1" | sed -n 's/^command\t//p'; }

table() {
  local top lines verb inner
  top=$(page)
  echo "$top"
  for verb in $(commands "$top"); do
    "$program" "$verb" --help > /dev/null 2>&1 || continue  # built without the viewer
    lines=$(page "$verb")
    echo "$lines"
    for inner in $(commands "$lines"); do page "$verb" "$inner"; done
  done
}

if [ "$shell" = table ]; then table; else table | awk -f "$here/$shell.awk"; fi
