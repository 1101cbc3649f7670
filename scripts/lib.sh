# Sourced by the scripts here; not run by itself.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '\n== %s\n' "$*" >&2; }
die() { printf 'error: %s\n' "$*" >&2; exit "${2:-1}"; }

# The number of jobs: as many as there are cores, but no more than one for each 1.5 GiB of free memory.
jobs() {
  local cores memory
  cores=$(nproc)
  memory=$(awk '/MemAvailable/ {print int($2 / 1572864)}' /proc/meminfo)
  [ "$memory" -lt 1 ] && memory=1
  echo $((cores < memory ? cores : memory))
}

# Configures and builds a preset, with its tests unless with_tests=OFF is set (they need more packages).
build() {
  local preset=$1
  shift
  (cd "$root" && cmake --preset "$preset" -DPERIOST_TESTS="${with_tests:-ON}" >"$root/build/$preset.configure.log" 2>&1) ||
    { tail -n 30 "$root/build/$preset.configure.log" >&2; die "cmake could not configure preset '$preset'"; }
  (cd "$root" && cmake --build --preset "$preset" -j "$(jobs)" "$@")
}

# The CT head of Debian's invesalius-examples, fetched if need be.
cranium() {
  local folder
  folder=$("$root/scripts/fetch_data.sh" invesalius-examples) || return 1
  find "$folder" -name Cranium.inv3 -print -quit
}
