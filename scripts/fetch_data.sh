#!/bin/sh
# Fetches real images that Debian packages, without installing the packages (slim systems drop documentation, and
# libcgal-demo would bring a compiler's worth of dependencies). Prints the folder of each on standard output.
#
#   scripts/fetch_data.sh [PACKAGE...]      default: invesalius-examples
#
# The cache is $PERIOST_CACHE, else ${XDG_CACHE_HOME:-~/.cache}/periost/data. What is there already is not fetched again.
set -eu

cache=${PERIOST_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/periost/data}
if [ "$#" -eq 0 ]; then
  set -- invesalius-examples
fi

fail() {
  echo "fetch_data.sh: $1" >&2
  exit 1
}

known_to_apt() {
  apt-cache show "$1" >/dev/null 2>&1
}

# Package lists may be missing (slim images delete them); refreshing them takes root's rights.
update_lists() {
  if [ "$(id -u)" -eq 0 ]; then
    apt-get update -qq >&2
  elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then
    sudo apt-get update -qq >&2
  else
    fail "apt does not know '$1' and refreshing its lists needs root: run 'sudo apt-get update', then this script again"
  fi
}

fetch() {
  package=$1
  work=$(mktemp -d "$cache/.fetch-XXXXXX")
  trap 'rm -rf "$work"' EXIT INT TERM
  # apt downloads as its own user when run by root; a folder that it may not write to only costs a warning.
  known_to_apt "$package" || update_lists "$package"
  (cd "$work" && apt-get download -qq "$package" >&2) || {
    update_lists "$package"
    (cd "$work" && apt-get download -qq "$package" >&2) || fail "cannot download '$package'; is there a network?"
  }
  mkdir "$work/tree"
  dpkg-deb -x "$work"/*.deb "$work/tree" || fail "cannot unpack '$package'"
  # libcgal-demo keeps its images in an archive of its own.
  if [ -f "$work/tree/usr/share/doc/libcgal-dev/data.tar.gz" ]; then
    tar -xzf "$work/tree/usr/share/doc/libcgal-dev/data.tar.gz" -C "$work/tree/usr/share/doc/libcgal-dev" ||
      fail "cannot unpack the data of '$package'"
  fi
  # Renamed into place when whole, so an interrupted run leaves nothing that looks complete.
  mv -T "$work/tree" "$cache/$package" 2>/dev/null || [ -d "$cache/$package" ] || fail "cannot write to $cache"
  rm -rf "$work"
  trap - EXIT INT TERM
}

command -v dpkg-deb >/dev/null 2>&1 || fail "dpkg-deb is missing: this script needs Debian or a relative of it"
mkdir -p "$cache" || fail "cannot create $cache; set PERIOST_CACHE to a folder that you may write to"
for package in "$@"; do
  case $package in
    invesalius-examples | libcgal-demo | mricron-data) ;;
    *) fail "unknown package '$package'; known are invesalius-examples, libcgal-demo, mricron-data" ;;
  esac
  [ -d "$cache/$package" ] || fetch "$package"
  echo "$cache/$package"
done
