#!/usr/bin/env bash
# Proves the README on a bare Debian 12: a minimal root made by debootstrap, entered by chroot, with a clone of the
# committed tree inside and nothing installed by hand. Needs root.
#   scripts/test-bare.sh [COMMAND]    default: scripts/demo.sh
set -euo pipefail
. "$(dirname "$0")/lib.sh"
[ "$(id -u)" = 0 ] || die "debootstrap and chroot need root"
command -v debootstrap >/dev/null || apt-get install -y -q --no-install-recommends debootstrap

bare=${PERIOST_BARE_ROOT:-/var/tmp/periost-bare}
if [ ! -e "$bare/etc/debian_version" ]; then
  say "making a minimal Debian 12 in $bare"
  mirror=$(grep -rhoE 'https?://[^ ]*debian\.org/debian\b' /etc/apt/sources.list /etc/apt/sources.list.d 2>/dev/null |
    grep -v snapshot | head -n 1 || true)  # without a match, or a list: Debian's own
  debootstrap --variant=minbase bookworm "$bare" "${mirror:-http://deb.debian.org/debian}"
fi
# The host's way to its package mirror, and to its certificates where that way is encrypted.
mkdir -p "$bare/etc/apt/apt.conf.d" "$bare/usr/local/share/ca-certificates"
for file in /etc/apt/apt.conf.d/*; do
  grep -qiE 'proxy|ssl|https|verify' "$file" 2>/dev/null && cp "$file" "$bare/etc/apt/apt.conf.d/"
done
cp /etc/resolv.conf "$bare/etc/resolv.conf" 2>/dev/null || true

rm -rf "$bare/periost"
git -C "$root" bundle create "$bare/periost.bundle" HEAD main >/dev/null 2>&1 ||
  git -C "$root" bundle create "$bare/periost.bundle" HEAD
git clone -q "$bare/periost.bundle" "$bare/periost"

mounted=()
leave() { for ((i = ${#mounted[@]} - 1; i >= 0; --i)); do umount -l "${mounted[i]}" || true; done; }
trap leave EXIT
for place in proc dev sys; do
  mount --rbind "/$place" "$bare/$place"
  mount --make-rslave "$bare/$place"
  mounted+=("$bare/$place")
done

say "running ${1:-scripts/demo.sh} in the bare system"
chroot "$bare" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb LANG=C.UTF-8 \
  bash -c "cd /periost && ${1:-scripts/demo.sh}"
