#!/bin/sh
# Functions that two object files both have are one function to the linker, which takes either. So what is compiled for
# an instruction set may share none with code that runs everywhere: every symbol that others could take for theirs must
# bear the tag of its set.
#   kernels_share_nothing.sh NM OBJECT...
nm=$1
shift
checked=0
for object in "$@"; do
  case $object in
    *kernels_avx2.cc.o) tag=Avx2Set ;;
    *kernels_avx512.cc.o) tag=Avx512Set ;;
    *) continue ;;
  esac
  checked=$((checked + 1))
  weak=$("$nm" -C --defined-only "$object" | grep -E '^[0-9a-f]+ [WVuw] ')
  shared=$(echo "$weak" | grep -v "$tag")
  if [ -n "$shared" ]; then
    echo "$object: compiled for an instruction set, and shared with other code:"
    echo "$shared"
    exit 1
  fi
  if ! echo "$weak" | grep -q "$tag"; then
    echo "$object: no function of $tag; is this the right file?"
    exit 1
  fi
done
if [ $checked -ne 2 ]; then
  echo "$checked object files of instruction sets, not 2"
  exit 1
fi
