#!/usr/bin/env bash
# Installs every Debian package that building, testing and running Periost need. Safe to run again.
#   scripts/setup.sh                 everything
#   scripts/setup.sh --runtime-only  what the built program needs to run
set -euo pipefail
. "$(dirname "$0")/lib.sh"

runtime=(libvtk9.1 libvtkdicom0.8 libyaml-cpp0.7 libfmt9 libspdlog1.10 libtbb12 libxxhash0 libtet1.5 zlib1g
  calculix-ccx ca-certificates)
build=(g++ cmake ninja-build ccache git libvtk9-dev libvtk-dicom-dev libeigen3-dev libyaml-cpp-dev libfmt-dev
  libspdlog-dev libcli11-dev nlohmann-json3-dev libtbb-dev libxxhash-dev libtet1.5-dev zlib1g-dev)
check=(libgtest-dev libgmock-dev libcgal-dev clang-format-16 clang-tidy-16)

case "${1:-}" in
  --runtime-only) wanted=("${runtime[@]}") ;;
  "") wanted=("${runtime[@]}" "${build[@]}" "${check[@]}") ;;
  *) die "unknown argument '$1'; use --runtime-only or nothing" 2 ;;
esac
# Node is for rebuilding the report page; a newer one than Debian's may be on the PATH already.
if [ "${1:-}" = "" ] && ! command -v node >/dev/null; then wanted+=(nodejs npm); fi

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
