#!/usr/bin/env bash
# The unit tests under the address and undefined-behaviour sanitizers.
#   scripts/test-sanitizers.sh          the folders that the gate has time for
#   scripts/test-sanitizers.sh --all    every unit test
set -euo pipefail
. "$(dirname "$0")/lib.sh"
mkdir -p "$root/build"

gate=(base config geometry io param)
if [ "${1:-}" = "--all" ]; then
  pattern='^unit\.'
  targets=()
else
  pattern="^unit\.($(IFS='|'; echo "${gate[*]}"))\."
  targets=(--target "${gate[@]/#/test_unit_}")
fi
say "building with sanitizers"
build asan "${targets[@]}"
say "unit tests with sanitizers"
cd "$root"
# Leaks are not looked for: VTK and TBB keep memory until the end by design.
ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 ctest --preset asan -R "$pattern" -j "$(jobs)"
