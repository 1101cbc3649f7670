#!/usr/bin/env bash
# Sets up, builds and runs the whole test suite. Real images in the folder PERIOST_TEST_DATA are used when it is set.
set -euo pipefail
. "$(dirname "$0")/lib.sh"

mkdir -p "$root/build"
"$root/scripts/setup.sh"
say "building"
build release
say "testing"
cd "$root"
if image=$(cranium 2>/dev/null); then export PERIOST_CRANIUM="$image"; fi
ctest --preset release -j "$(jobs)" "$@"
