#!/usr/bin/env bash
# Reads the sources as clang for macOS would, as far as that goes without a Mac: scripts/macos_check.sh [FILE ...]
# The compiler's target is macOS and its library libc++, as there; Apple's own headers are not free, so those of Linux stand
# for POSIX, and a few declarations below for the rest. Nothing is linked or run. Needs clang and libc++ of version 16
# (Debian: clang-16, libc++-16-dev) and a build in build/release, whose generated headers are read.
set -euo pipefail
cd "$(dirname "$0")/.."
version=${XRDS_CLANG:-16}
headers=/usr/lib/llvm-$version/include/c++/v1
build=${XRDS_BUILD:-build/release}
[ -d "$headers" ] && command -v "clang++-$version" > /dev/null || { echo "This needs clang-$version and libc++-$version-dev." >&2; exit 1; }
[ -d "$build/shaders/include" ] || { echo "There is no $build: build it first." >&2; exit 1; }

stubs=$(mktemp -d)
trap 'rm -rf "$stubs"' EXIT
mkdir "$stubs/mach-o"
cat > "$stubs/mach-o/dyld.h" <<'END'
#include <stdint.h>
extern "C" int _NSGetExecutablePath(char* path, uint32_t* size);
END
# What libc++ calls there, with Linux's macros of the same names out of its way.
cat > "$stubs/xlocale.h" <<'END'
#pragma once
#include <ctype.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <wchar.h>
#undef isdigit_l
#undef isxdigit_l
extern "C" {
struct lconv* localeconv_l(locale_t);
int snprintf_l(char*, size_t, locale_t, const char*, ...);
int asprintf_l(char**, locale_t, const char*, ...);
int vasprintf_l(char**, locale_t, const char*, va_list);
int sscanf_l(const char*, locale_t, const char*, ...);
wint_t btowc_l(int, locale_t);
int wctob_l(wint_t, locale_t);
size_t mbrtowc_l(wchar_t*, const char*, size_t, mbstate_t*, locale_t);
size_t mbrlen_l(const char*, size_t, mbstate_t*, locale_t);
size_t mbsrtowcs_l(wchar_t*, const char**, size_t, mbstate_t*, locale_t);
size_t mbsnrtowcs_l(wchar_t*, const char**, size_t, size_t, mbstate_t*, locale_t);
size_t wcrtomb_l(char*, wchar_t, mbstate_t*, locale_t);
size_t wcsnrtombs_l(char*, const wchar_t**, size_t, size_t, mbstate_t*, locale_t);
int mbtowc_l(wchar_t*, const char*, size_t, locale_t);
}
END
files=("$@")
if [ $# -eq 0 ]; then
  mapfile -t files < <(find engine shaders graph network frames checks tuning api image advice sequence app cli -name '*.cpp' ! -name '*_test.cpp' \
    ! -name test_files.cpp | sort)
fi
options=("--target=$(uname -m)-apple-macos13" -U__nonnull -D_GNU_SOURCE -std=c++20 -fsyntax-only -nostdinc++ -Wall -Wextra -Wno-missing-field-initializers
  -isystem "$headers" -isystem "$stubs" -isystem /usr/include/OpenEXR -isystem /usr/include/Imath -isystem "/usr/include/$(uname -m)-linux-gnu"
  -isystem /usr/include -I. -Iinclude -I"$build/shaders/include" -I"$build/shaders" -I"$build/engine" -DVK_NO_PROTOTYPES
  -DXRDS_VERSION=\"0\" -DXRDS_VERSION_MAJOR=0 -DXRDS_VERSION_MINOR=0 -DXRDS_VERSION_PATCH=0)
bad=0
for file in "${files[@]}"; do
  "clang++-$version" "${options[@]}" "$file" || { echo "FAILED $file"; bad=$((bad + 1)); }
done
echo "${#files[@]} sources read as for macOS, $bad with errors"
[ $bad -eq 0 ]
