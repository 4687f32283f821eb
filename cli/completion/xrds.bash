# Bash completion for xrds: source it, or install it as share/bash-completion/completions/xrds.
_xrds() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} verb=${COMP_WORDS[1]}
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "upscale compare info devices --help --version" -- "$current")
    return
  fi
  case $previous in
    --precision) mapfile -t COMPREPLY < <(compgen -W "fp32 fp16" -- "$current"); return ;;
    --exposure) mapfile -t COMPREPLY < <(compgen -W "auto" -- "$current"); return ;;
  esac
  if [[ $current == -* ]]; then
    # The options are read from the program itself, so that this list cannot go stale.
    local options
    options=$("${COMP_WORDS[0]}" "$verb" --help 2>/dev/null | grep -oE -- '(^|[ ,])--?[a-z][a-z-]*' | tr -d ' ,')
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}
complete -o filenames -F _xrds xrds
