# Makes a section of a manual page of one command's --help: description, usage, a list for each group of options, and
# what stands below as it is.
function plain(text) {
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  if (text ~ /^[.']/) text = "\\&" text
  return text
}
BEGIN { section = "description"; print ".SH " toupper(title) }
/^Usage:/ { print ".PP\n\\fB" plain($0) "\\fR"; section = "usage"; next }
/^(Positionals|Options|Subcommands):$/ { print ".SS " $1; section = "list"; next }
# Descriptions begin in column 31, none with a dash; a longer term stands alone on its line.
section == "list" && /^  [^ ]/ {
  term = substr($0, 3, 28)
  alone = length($0) <= 30 || substr($0, 30, 1) != " " || substr($0, 31, 1) == "-" || gsub(/[[{]/, "&", term) != gsub(/[]}]/, "&", term)
  if (alone) term = substr($0, 3)
  sub(/ +$/, "", term)
  print ".TP\n\\fB" plain(term) "\\fR"
  if (!alone) print plain(substr($0, 31))
  next
}
section == "list" && /^ / { sub(/^ +/, ""); print plain($0); next }
section == "list" && /^[^ ]/ { section = "below"; print ".PP\n.nf" }
section == "below" { print plain($0); next }
section == "usage" || /^$/ { next }
{ print plain($0) }
END { if (section == "below") print ".fi" }
