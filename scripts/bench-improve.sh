#!/usr/bin/env bash
# improve beside TetGen: the skull at 0.3 voxel, with its own tetrahedra and with smaller ones, processor seconds and
# wall time of both stages on two threads, microseconds a tetrahedron and growth of their number.
#   scripts/bench-improve.sh [VOLUME...]    largest tetrahedra in mm3, 0: no limit; default: 0 0.5 0.06 0.03
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cd "$root"

PERIOST_CRANIUM=${PERIOST_CRANIUM:-$(cranium)}
export PERIOST_CRANIUM
mkdir -p build
build release --target periost periost-tetgen >/dev/null
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/skull.yaml" <<'YAML'
periost: 1
name: skull
chain:
  - stage: read_image
    path: ${PERIOST_CRANIUM}
  - stage: threshold
    lower: 226
    keep: largest
    fill_holes: all
  - stage: marching_cubes
    keep: largest
  - stage: decimate
    distance: 0.3 voxel
  - stage: triangulate
  - stage: tetgen
  - stage: improve
YAML
[ $# -eq 0 ] && set -- 0 0.5 0.06 0.03
# Stages before TetGen are taken from the first run.
mode=--force
for volume in "$@"; do
  build/release/bin/periost run "$work/skull.yaml" --set "tetgen.max_volume=${volume}mm3" --out "$work/out" $mode \
    --threads 2 --progress none >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
  mode=--resume
  python3 - "$work/out" "$volume" <<'PYTHON'
import json, sys
run = json.load(open(sys.argv[1] + "/run.json"))
stages = {stage["kind"]: stage for stage in run["stages"]}
def tets(stage):
    return next(o["facts"]["tets"] for o in stages[stage]["outputs"] if "tets" in o.get("facts", {}))
before, after = tets("tetgen"), tets("improve")
tetgen, improve = stages["tetgen"], stages["improve"]
print(f'up to {sys.argv[2]} mm3: {before:.0f} -> {after:.0f} tetrahedra ({100 * (after / before - 1):+.1f} %); '
      f'TetGen {tetgen["wall_s"]:.2f} s ({tetgen["cpu_s"]:.2f} of processors), '
      f'improve {improve["wall_s"]:.2f} s ({improve["cpu_s"]:.2f}), '
      f'{1e6 * improve["cpu_s"] / before:.1f} us a tetrahedron')
PYTHON
done
