# Makes the lines of completion.sh of one command's --help; `path` is the command.
function flush() {
  if (kind != "") print line description
  kind = description = ""
}
BEGIN { OFS = "\t" }
/^[^ ]/ { flush(); section = $1; next }
section !~ /^(Positionals|Options|Subcommands):$/ || /^$/ { next }
# Descriptions begin in column 31, none with a dash; a longer term stands alone on its line.
/^  [^ ]/ {
  flush()
  term = substr($0, 3, 28)
  alone = length($0) <= 30 || substr($0, 30, 1) != " " || substr($0, 31, 1) == "-" || gsub(/[[{]/, "&", term) != gsub(/[]}]/, "&", term)
  if (alone) term = substr($0, 3)
  else description = substr($0, 31)
  sub(/ +$/, "", term)
  split(term, words, " ")
  type = words[2] ~ /^(REQUIRED|Needs:|Excludes:)$/ ? "" : words[2]
  kind = section == "Options:" ? "option" : section == "Positionals:" ? "positional" : "command"
  line = kind OFS path OFS words[1] OFS (kind == "option" ? type OFS : "")
  next
}
/^ / { sub(/^ +/, ""); description = description (description == "" ? "" : " ") $0 }
END { flush() }
