#!/usr/bin/env bash
# The unit tests under the address and undefined-behaviour sanitizers.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
mkdir -p "$root/build"
say "building with sanitizers"
build asan
say "unit tests with sanitizers"
cd "$root"
# Allocators of VTK's and TBB's own keep memory until the end; leaks are looked for in our own code by design reviews.
ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 ctest --preset asan -R '^unit\.' -j "$(jobs)" "$@"
