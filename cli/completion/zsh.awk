# Makes the completion for zsh of the lines of completion.sh.
function escaped(text) { gsub(/[][\\:]/, "\\\\&", text); gsub(/'/, "'\\''", text); return text }
# What an option of a type takes: ":NAME:ACTION", or nothing.
function value(type, name) {
  if (type == "") return ""
  name = type
  sub(/[:={|].*$/, "", name)
  if (type ~ /[{].*[}]/) { sub(/^.*[{]/, "", type); sub(/[}].*$/, "", type); gsub(/,/, " ", type); return ":" name ":(" type ")" }
  if (type ~ /[|]/) {
    sub(/=.*/, "", type); sub(/^.*:/, "", type); gsub(/[|]/, " ", type); gsub(/ *[A-Z][A-Z,]*/, "", type); sub(/^ /, "", type)
    return ":" name ":" (type == "" ? " " : "(" type ")")
  }
  if (type ~ /^MODEL/) return ":" name ":_xrds_models"
  if (type ~ /^SCENE/) return ":" name ":_xrds_scenes"
  return ":" name ":" (type ~ /EXR|PNG|JSON|MD|FILE|FOLDER/ ? "_files" : " ")
}
function specification(names, type, description,    n, k, name, text) {
  n = split(names, name, ",")
  for (k = 1; k <= n; ++k)
    text = text " \\\n        '" name[k] (type != "" && name[k] ~ /^--/ ? "=" : "") "[" escaped(description) "]" value(type) "'"
  return text
}
function call(path, depth) {
  return "shift " depth " words; (( CURRENT -= " depth " )); _arguments" options[path] rest[path]
}
BEGIN { FS = "\t"; group[""] }
$1 == "command" {
  group[$2]
  verbs[$2] = verbs[$2] " \\\n        '" escaped($3) ":" escaped($4) "'"
  if ($2 == "") order[++count] = $3
  else inner[$2] = inner[$2] " " $3
}
$1 == "option" { options[$2] = options[$2] specification($3, $4, $5) }
$1 == "positional" { rest[$2] = " \\\n        '*:" $3 ":" ($3 ~ /^MODEL/ ? "_xrds_models" : "_files") "'" }
END {
  print "#compdef xrds\n# Completion of xrds for zsh, made of its --help."
  print "_xrds_models() { compadd -- ${(f)\"$(xrds info 2>/dev/null)\"}; _files -g '*.safetensors' }"
  print "_xrds_scenes() { compadd room garden spheres; _files }"
  print "_xrds() {\n  local -a commands"
  print "  if (( CURRENT == 2 )); then\n    commands=(" verbs[""] ")\n    _describe command commands\n    _arguments" options[""] "\n    return\n  fi"
  print "  case $words[2] in"
  for (i = 1; i <= count; ++i) {
    verb = order[i]
    if (!(verb in group)) {
      if (verb in options) print "    " verb ") " call(verb, 1) " ;;"
      continue
    }
    print "    " verb ")\n      if (( CURRENT == 3 )); then\n        commands=(" verbs[verb] ")\n        _describe command commands\n        " call(verb, 1) "\n        return\n      fi"
    print "      case $words[3] in"
    n = split(inner[verb], name, " ")
    for (k = 1; k <= n; ++k) print "        " name[k] ") " call(verb " " name[k], 2) " ;;"
    print "      esac ;;"
  }
  print "  esac\n}"
  print "if [ \"$funcstack[1]\" = _xrds ]; then _xrds \"$@\"; else compdef _xrds xrds; fi"
}
