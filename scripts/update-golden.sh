#!/usr/bin/env bash
# Rewrites the facts that the golden tests expect, printing each value that changed. Look before you commit.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
build release --target periost periost-tetgen test_golden test_acceptance
cd "$root"
if image=$(cranium 2>/dev/null); then export PERIOST_CRANIUM="$image"; fi
export PERIOST_UPDATE_GOLDEN=1
build/release/tests/test_golden
build/release/tests/test_acceptance --gtest_filter=*KeepsItsGoldenFacts
