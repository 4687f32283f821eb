#!/usr/bin/env bash
# completion_test.sh SCRIPT PROGRAM: asks the completion what it offers.
set -uo pipefail
source "$1"
program=$2
failures=0
typed() {  # typed WORD...: what is offered for the last word
  COMP_WORDS=("$program" "$@")
  COMP_CWORD=$#
  _xrds
}
offers() {  # offers EXPECTED WORD...: the last word is the one being typed
  local expected=$1
  shift
  typed "$@"
  case " ${COMPREPLY[*]} " in
    *" $expected "*) ;;
    *) echo "'$*' should offer '$expected', offers '${COMPREPLY[*]}'"; failures=$((failures + 1)) ;;
  esac
}
offers upscale up
offers doctor do
offers --runs doctor --r
offers --version --v
offers fp16 upscale a.exr --precision f
offers --side-by-side upscale a.exr --s
offers --output upscale --o
offers --heat-map compare --he
offers --reference-layer compare --r
offers --size info --
offers --json info --j
offers --json devices --j
offers fused info xrds-x4-nano --kernels f
offers quality bench q
offers network bench n
offers --scenes bench network --sc
offers --markdown bench quality val --m
offers fp16 bench quality val --precision f
offers converged bench quality val --aux c
offers xrds-x4-compact bench quality val --model xrds
offers fused bench network --family f
offers tile,matrix bench network --family tile,m
offers 8 upscale --ensemble ''
offers safe upscale --skip ''
offers --json upscale --j
offers oidn import o
offers prefilter denoise --guides p
offers --colour upscale --colo
offers xrds-x4-compact info xrds
offers xrds-x4-compact upscale --model xrds
# Where there is a viewer: its options, and its scenes.
if "$program" view --help > /dev/null 2>&1; then
  offers --live view --l
  offers garden view --live ''
  offers fp16 view --precision f
fi
# Every command and every option that --help lists is offered.
for verb in '' upscale compare info devices doctor tune denoise import 'import oidn' bench 'bench quality' 'bench network' 'bench skip' 'bench stress' 'bench tiles'; do
  # shellcheck disable=SC2086
  typed $verb --
  for option in $("$program" $verb --help | grep -oE -- '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--.*'); do
    case " ${COMPREPLY[*]} " in
      *" $option "*) ;;
      *) echo "'$verb' should offer '$option'"; failures=$((failures + 1)) ;;
    esac
  done
done
# A layer, a device, a number: nothing to offer.
typed upscale --albedo ''
[ ${#COMPREPLY[@]} -eq 0 ] || { echo "--albedo offers '${COMPREPLY[*]}'"; failures=$((failures + 1)); }
complete -p xrds > /dev/null || failures=$((failures + 1))
exit $((failures > 0))
