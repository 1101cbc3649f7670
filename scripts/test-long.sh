#!/usr/bin/env bash
# Checks that take longer than the gate allows: clang-tidy over the whole tree, the sanitizers over every test, the demo on
# a bare system.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
mkdir -p "$root/build"
"$root/scripts/setup.sh"
"$root/scripts/check-style.sh"
"$root/scripts/test-sanitizers.sh" --all
say "every test with sanitizers"
(cd "$root" && ASAN_OPTIONS=detect_leaks=0 ctest --preset strict -E '^unit\.' -j "$(jobs)")
"$root/scripts/test-bare.sh"
"$root/scripts/test-bare.sh" scripts/test.sh
