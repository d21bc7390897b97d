#!/usr/bin/env bash
# Proves that a fresh machine needs nothing but this repository: makes a minimal Debian 12 in a folder, unpacks the last
# commit into it, and runs scripts/test.sh and scripts/demo.sh there. Needs root, a package source, and about 8 GB.
# Usage: scripts/test_fresh.sh [FOLDER]      default: a temporary folder, removed afterwards
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() { echo "test_fresh: $*" >&2; exit 1; }

[ "$(id -u)" -eq 0 ] || fail "must run as root: it makes and enters a chroot."
command -v mmdebstrap >/dev/null || fail "mmdebstrap is missing: apt-get install mmdebstrap"

if [ $# -gt 0 ]; then
  mkdir -p "$1"
  root=$(cd "$1" && pwd)
  [ -z "$(ls -A "$root")" ] || fail "$root is not empty."
  trap 'umount "$root/proc" "$root/dev/shm" "$root/dev" 2>/dev/null || true' EXIT
else
  root=$(mktemp -d)
  # --one-file-system: whatever could not be unmounted must not be emptied.
  trap 'umount "$root/proc" "$root/dev/shm" "$root/dev" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
fi

commit=$(git rev-parse HEAD)  # commits may be added while this runs

# The host's own package sources and apt settings (proxy, certificates, dates).
sources=()
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.sources /etc/apt/sources.list.d/*.list; do
  [ -s "$file" ] && sources+=("$file")
done
options=()
for file in /etc/apt/apt.conf /etc/apt/apt.conf.d/*; do
  if [ -f "$file" ] && grep -qiE 'proxy|verify|check-' "$file"; then options+=("--aptopt=$file"); fi
done
echo "test_fresh: making a minimal Debian 12 in $root"
mmdebstrap --quiet --variant=minbase --include=ca-certificates "${options[@]}" bookworm "$root" "${sources[@]}"

[ ! -f /etc/resolv.conf ] || cp -L /etc/resolv.conf "$root/etc/resolv.conf"
[ ! -d /usr/local/share/ca-certificates ] || cp -a /usr/local/share/ca-certificates/. "$root/usr/local/share/ca-certificates/"
chroot "$root" update-ca-certificates >/dev/null 2>&1 || true
# A minimal system does not know its own name; roslaunch asks for it.
printf '127.0.0.1 localhost\n127.0.1.1 %s\n' "$(hostname)" >> "$root/etc/hosts"
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
mount -t tmpfs tmpfs "$root/dev/shm" 2>/dev/null || true

mkdir -p "$root/home/package"
git archive "$commit" | tar -x -C "$root/home/package"
inside() { chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 "$@"; }
inside /home/package/scripts/test.sh
inside /home/package/scripts/demo.sh
echo "test_fresh: commit ${commit:0:7} builds, passes its tests and runs its demo on a fresh Debian 12"
