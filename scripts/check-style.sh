#!/usr/bin/env bash
# clang-format on every source, clang-tidy on the sources changed since a commit (default: all), warnings as errors.
#   scripts/check-style.sh [--tidy-since COMMIT | --no-tidy]
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cd "$root"

mapfile -t sources < <(git ls-files '*.cpp' '*.h')
say "clang-format"
clang-format-16 --dry-run -Werror "${sources[@]}"

say "warnings as errors"
mkdir -p build
build strict

[ "${1:-}" = "--no-tidy" ] && exit 0
say "clang-tidy"
if [ "${1:-}" = "--tidy-since" ]; then
  mapfile -t changed < <(git diff --name-only --diff-filter=d "$2" -- 'pipeline/*.cpp' 'stages/*.cpp' 'workers/*.cpp')
else
  mapfile -t changed < <(git ls-files 'pipeline/*.cpp' 'stages/*.cpp' 'workers/*.cpp')
fi
[ ${#changed[@]} -eq 0 ] && exit 0
# Clang reads no headers that GCC precompiled: the preset tidy, configured only, lists commands without them.
cmake --preset tidy >build/tidy.configure.log
printf '%s\n' "${changed[@]}" | xargs -P "$(jobs)" -n 4 clang-tidy-16 -p build/tidy --quiet
