#!/usr/bin/env bash
# The unit tests under the address and undefined-behaviour sanitizers (preset strict, assertions on). Two large ones are left
# out, whose code smaller ones run; scripts/test-long.sh has all.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
mkdir -p "$root/build"

say "building with sanitizers"
build strict
say "unit tests with sanitizers"
large='RegionsDoNotShowInTheResult|KeepThePromisesOfTheWhole'
if [ "${1:-}" = --all ]; then
  large='^$'
  shift
fi
cd "$root"
# Leaks are not looked for: VTK and TBB keep memory until the end by design.
ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 ctest --preset strict -R '^unit\.' -E "$large" -j "$(jobs)" "$@"
