#!/usr/bin/env bash
# completion_test.sh SCRIPT PROGRAM: asks the completion what it offers.
set -uo pipefail
source "$1"
program=$2
failures=0
offers() {  # offers EXPECTED WORD...: the last word is the one being typed
  local expected=$1
  shift
  COMP_WORDS=("$program" "$@")
  COMP_CWORD=$#
  _xrds
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
offers xrds-x4-compact info xrds
offers xrds-x4-compact upscale --model xrds
complete -p xrds > /dev/null || failures=$((failures + 1))
exit $((failures > 0))
