#!/usr/bin/env bash
# Installs the Debian packages that Periost needs. Safe to run again.
#   scripts/setup.sh                 everything: building, running, testing
#   scripts/setup.sh --build-only    what building and running need
#   scripts/setup.sh --runtime-only  what the built program needs to run
set -euo pipefail
. "$(dirname "$0")/lib.sh"

runtime=(libvtk9.1 libyaml-cpp0.7 libfmt9 libspdlog1.10 libtbb12 libxxhash0 libtet1.5 zlib1g calculix-ccx ca-certificates)
build=(g++ cmake ninja-build ccache git libvtk9-dev libeigen3-dev libyaml-cpp-dev libfmt-dev libspdlog-dev
  libcli11-dev nlohmann-json3-dev libtbb-dev libxxhash-dev libtet1.5-dev zlib1g-dev)
check=(libgtest-dev libgmock-dev libcgal-dev clang-format-16 clang-tidy-16)

case "${1:-}" in
  --runtime-only) wanted=("${runtime[@]}") ;;
  --build-only) wanted=("${runtime[@]}" "${build[@]}") ;;
  "") wanted=("${runtime[@]}" "${build[@]}" "${check[@]}") ;;
  *) die "unknown argument '$1'; use --build-only, --runtime-only or nothing" 2 ;;
esac

missing=()
for package in "${wanted[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  if command -v sudo >/dev/null; then
    as_root=(sudo)
  else
    printf 'Some Debian packages are missing. As root, run:\n  apt-get update && apt-get install -y --no-install-recommends %s\n' "${missing[*]}" >&2
    exit 1
  fi
fi
say "installing ${#missing[@]} Debian packages"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}"
