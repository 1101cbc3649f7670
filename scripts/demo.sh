#!/usr/bin/env bash
# Sets up, builds and runs the main job: a real CT head to a surface, a tetrahedral mesh, a solver deck and a verdict.
#   scripts/demo.sh [OUTPUT FOLDER]
set -euo pipefail
. "$(dirname "$0")/lib.sh"

out=${1:-$root/runs/cranium}
mkdir -p "$root/build"
"$root/scripts/setup.sh" --build-only
say "building"
with_tests=OFF build release --target periost periost-tetgen
say "fetching the CT head of Debian's invesalius-examples"
PERIOST_CRANIUM=$(cranium)
export PERIOST_CRANIUM
say "running configs/cranium.yaml"
"$root/build/release/bin/periost" run "$root/configs/cranium.yaml" --out "$out" --force
printf '\nLook at %s with ParaView, or feed %s to CalculiX.\n' "$out/volume.vtu" "$out/cranium.inp"
