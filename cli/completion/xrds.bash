# Bash completion for xrds: source it, or install it as share/bash-completion/completions/xrds.
_xrds() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} verb=${COMP_WORDS[1]} program=${COMP_WORDS[0]}
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "upscale compare info devices doctor view bench --help --version" -- "$current")
    return
  fi
  local verbs=("$verb")
  if [ "$verb" = bench ]; then
    if [ "$COMP_CWORD" -eq 2 ]; then
      mapfile -t COMPREPLY < <(compgen -W "network quality skip stress tiles --help" -- "$current")
      return
    fi
    verbs+=("${COMP_WORDS[2]}")
  fi
  # Options and models are read from the program itself, so that this list cannot go stale.
  case $previous in
    --ensemble) mapfile -t COMPREPLY < <(compgen -W "1 2 4 8" -- "$current"); return ;;
    --precision) mapfile -t COMPREPLY < <(compgen -W "fp32 fp16" -- "$current"); return ;;
    --family | --kernels) mapfile -t COMPREPLY < <(compgen -W "plain lane tile matrix fused" -- "$current"); return ;;
    --skip) mapfile -t COMPREPLY < <(compgen -W "off safe" -- "$current"); return ;;
    --tiles) mapfile -t COMPREPLY < <(compgen -W "exact bounded" -- "$current"); return ;;
    --aux) mapfile -t COMPREPLY < <(compgen -W "converged" -- "$current"); return ;;
    --exposure) mapfile -t COMPREPLY < <(compgen -W "auto" -- "$current"); return ;;
    --model) mapfile -t COMPREPLY < <(compgen -W "$("$program" info 2>/dev/null)" -- "$current"; compgen -f -- "$current"); return ;;
    --color | --albedo | --normal | --depth | --layer | --reference-layer | --device | --size | --memory | --halo | --columns | --rows | --heat-max | --min-psnr | --scale | --colour | --runs) return ;;
  esac
  if [[ $current == -* ]]; then
    local options
    options=$("$program" "${verbs[@]}" --help 2>/dev/null | grep -oE -- '^ +(-[a-z],)?--[a-z-]+' | tr ',' '\n')
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  elif [ "$verb" = info ]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" info 2>/dev/null)" -- "$current"; compgen -f -- "$current")
  elif [ "$verb" != devices ]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}
complete -o filenames -F _xrds xrds
