#!/usr/bin/env bash
# Installs the packages of scripts/packages.txt that are missing (Debian 12, as root or through sudo).
# Usage: scripts/setup.sh        returns at once when everything is there
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() { echo "setup: $*" >&2; exit 1; }

command -v dpkg-query apt-get >/dev/null ||
  fail "this system has no apt. Build with plain CMake once the libraries named in package.xml are installed."

mapfile -t wanted < <(LC_ALL=C sort -u scripts/packages.txt)
mapfile -t missing < <(comm -23 <(printf '%s\n' "${wanted[@]}") \
  <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${wanted[@]}" 2>/dev/null |
    sed -n 's/^installed //p' | LC_ALL=C sort -u))
if [ ${#missing[@]} -eq 0 ]; then
  echo "setup: all ${#wanted[@]} packages are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null ||
    fail "these packages are missing and installing them needs root or sudo. As root: apt-get install ${missing[*]}"
  as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Another installation may hold apt's lock (unattended upgrades do so after boot).
apt_get() {
  local attempt
  for attempt in 1 2 3 4 5 6 7 8 9 10; do
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=60 "$@" >"$log" 2>&1 && return
    tail -n 5 "$log" >&2
    echo "setup: apt-get $1 failed (attempt $attempt of 10), trying again in 15 s" >&2
    sleep 15
  done
  return 1
}

echo "setup: installing ${#missing[@]} packages (a fresh system takes some minutes)"
apt_get update || fail "apt-get update failed; is there a network and a package source?"
mapfile -t unknown < <(comm -23 <(printf '%s\n' "${missing[@]}") \
  <(apt-cache policy "${missing[@]}" | awk '/^[^ ]/ { name = $1; sub(":$", "", name) }
    /Candidate:/ && $2 != "(none)" { print name }' | LC_ALL=C sort -u))
[ ${#unknown[@]} -eq 0 ] ||
  fail "this distribution has no ${unknown[*]}. The list is for Debian 12; where ROS comes from its own packages" \
       "(Ubuntu 20.04, Noetic) use: rosdep install --from-paths . --ignore-src"
apt_get install -y --no-install-recommends "${missing[@]}" || fail "apt-get install failed; see its messages above."
echo "setup: done"
