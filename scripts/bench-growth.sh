#!/usr/bin/env bash
# How decimate's time grows with the surface: rough balls of about 50 thousand, 500 thousand and 5 million triangles,
# to a tenth, processor seconds and peak memory per input triangle, and each time's ratio to the first.
#   scripts/bench-growth.sh [SIZE...]    voxels a side; default: 94 298 940
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cd "$root"

mkdir -p build
build release --target periost >/dev/null
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[ $# -eq 0 ] && set -- 94 298 940
for size in "$@"; do
  cat >"$work/ball.yaml" <<YAML
periost: 1
name: ball
chain:
  - stage: phantom
    shape: sphere
    size: [$size, $size, $size]
    noise: 60
    seed: 1
  - stage: threshold
    lower: 500
    keep: largest
    fill_holes: all
  - stage: marching_cubes
    keep: largest
  - stage: decimate
    distance: 0.3 voxel
    max_triangles: $((size * size * 56 / 100))
YAML
  build/release/bin/periost run "$work/ball.yaml" --out "$work/out" --force --progress none --verbose >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; exit 1; }
  python3 - "$work/out" "$size" <<'PYTHON' | tee -a "$work/times"
import json, sys
run = json.load(open(sys.argv[1] + "/run.json"))
stages = {stage["kind"]: stage for stage in run["stages"]}
before = stages["marching_cubes"]["outputs"][0]["facts"]["triangles"]
decimate = stages["decimate"]
print(f'{sys.argv[2]}^3 voxels, {before:.0f} triangles: {decimate["cpu_s"]:.1f} processor seconds, '
      f'{decimate["wall_s"]:.1f} s, {1e6 * decimate["cpu_s"] / before:.1f} us a triangle, '
      f'peak {decimate["peak_rss_bytes"] / before:.0f} bytes a triangle')
PYTHON
done
