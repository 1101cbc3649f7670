#!/usr/bin/env bash
# Decimates the same isosurfaces by this program, VTK and CGAL, and writes the tables of docs/benchmarks.md. About twenty
# minutes on two cores; let nothing else run.
#   scripts/bench-decimate.sh [CASE...]    default: cranium ventricle vessel femur
# Needs libcgal-dev besides what scripts/setup.sh installs.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cd "$root"

mkdir -p build
say "building"
cmake --preset release -B build/bench -DPERIOST_BENCHMARKS=ON -DPERIOST_BENCH_CGAL=ON \
  >build/bench.configure.log
cmake --build build/bench --target bench_decimate periost-tetgen -j "$(jobs)"
if image=$(cranium); then export PERIOST_CRANIUM="$image"; fi
say "measuring"
python3 scripts/bench_decimate.py build/bench/bin/bench_decimate docs/benchmarks.md "$@"
