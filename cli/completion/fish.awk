# Makes the completion for fish of the lines of completion.sh.
function quoted(text) { gsub(/\\/, "\\\\", text); gsub(/'/, "\\'", text); return "'" text "'" }
function condition(path) { return " -n " quoted((path in group ? "__xrds_only " : "__xrds_in ") path) }
# The words that a type offers; files where it names some; else whatever is typed.
function values(type) {
  if (type == "") return ""
  if (type ~ /[{].*[}]/) { sub(/^.*[{]/, "", type); sub(/[}].*$/, "", type); gsub(/,/, " ", type); return " -x -a " quoted(type) }
  if (type ~ /[|]/) {
    sub(/=.*/, "", type); sub(/^.*:/, "", type); gsub(/[|]/, " ", type); gsub(/ *[A-Z][A-Z,]*/, "", type); sub(/^ /, "", type)
    return " -x" (type == "" ? "" : " -a " quoted(type))
  }
  if (type ~ /^MODEL/) return " -r -F -a '(__xrds_models)'"
  if (type ~ /^SCENE/) return " -r -F -a 'room garden spheres'"
  return type ~ /EXR|PNG|JSON|MD|FILE|FOLDER/ ? " -r -F" : " -x"
}
BEGIN {
  FS = "\t"
  group[""]
  print "# Completion of xrds for fish, made of its --help."
  print "function __xrds_in\n    set -l words (commandline -opc)[2..-1]"
  print "    set -l depth (count $argv)\n    test (count $words) -ge $depth; and test \"$words[1..$depth]\" = \"$argv\"\nend"
  print "function __xrds_only\n    set -l words (commandline -opc)[2..-1]\n    test \"$words\" = \"$argv\"\nend"
  print "function __xrds_models\n    xrds info 2>/dev/null\nend"
}
{ lines[NR] = $0 }
$1 == "command" { group[$2] }
$1 == "positional" { takes[$2] = takes[$2] " " $3 }
END {
  for (i = 1; i <= NR; ++i) {
    split(lines[i], f, FS)
    if (f[1] == "command") print "complete -c xrds" condition(f[2]) " -f -a " quoted(f[3]) " -d " quoted(f[4])
    if (f[1] != "option") continue
    if (!(f[2] in seen)) {
      seen[f[2]]
      if (!(f[2] in takes)) print "complete -c xrds" condition(f[2]) " -f"
      if (takes[f[2]] ~ / MODEL/) print "complete -c xrds" condition(f[2]) " -a '(__xrds_models)'"
    }
    names = ""
    n = split(f[3], name, ",")
    for (k = 1; k <= n; ++k) {
      long = sub(/^--/, "", name[k])
      sub(/^-/, "", name[k])
      names = names (long ? " -l " : " -s ") name[k]
    }
    print "complete -c xrds" condition(f[2]) names values(f[4]) " -d " quoted(f[5])
  }
}
