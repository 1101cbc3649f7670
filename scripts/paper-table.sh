#!/usr/bin/env bash
# Runs the paper's examples with both methods and writes the table of docs/paper.md. Two to four minutes.
#   scripts/paper-table.sh [PERIOST]     the program; default: the release build, made if it is not there
# PERIOST_TEST_DATA names the folder with the real ventricles; without it their rows are left out.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cd "$root"

periost=${1:-build/release/bin/periost}
if [ ! -x "$periost" ]; then
  mkdir -p build
  build release
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
say "the paper's examples"
python3 scripts/paper_table.py "$periost" docs/paper.md "$work"
