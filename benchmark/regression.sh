#!/usr/bin/env bash
# The fixed regression set: every part of config/parts in virtual bins, made anew from seeds where it is not there yet, and
# one table of how well they are found. Bit for bit the same set on every run.
# Usage: benchmark/regression.sh [OPTION...] [-- EVALUATE_OPTION...]
#   --bins N        full bins of 25 per part, each with other seeds (default: 4)
#   --sensor NAME   structured_light (default), stereo or ideal
#   --size WxH      pixels of the camera (default: 1280x1024)
#   --parts DIR...  other parts than those of config/parts
#   --seed N        first seed (default: 0); settings are chosen on other seeds than figures are reported on
#   -o DIR          where set and report go (default: BUILD_DIR/regression)
#   BUILD_DIR=DIR   build folder (default: build)
# Per part: the full bins; a lone part; an empty bin; and a bin full of the next part, in which it is searched in vain.
# Writes DIR/report.{txt,json,html}. What follows -- goes to `bin_picking evaluate`: --preset accurate, --repeat 5, ...
set -euo pipefail
start_dir=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source_dir=$PWD

fail() { echo "regression: $*" >&2; exit 2; }
absolute() { case "$1" in /*) echo "$1" ;; *) echo "$start_dir/$1" ;; esac; }

bins=4
sensor=structured_light
size=1280x1024
first_seed=0
parts=()
build_dir=${BUILD_DIR:-build}
case "$build_dir" in /*) ;; *) build_dir=$source_dir/$build_dir ;; esac
out=$build_dir/regression
while [ $# -gt 0 ]; do
  case "$1" in
    -h|--help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    --bins) bins=${2:?--bins needs a number}; shift 2 ;;
    --sensor) sensor=${2:?--sensor needs a name}; shift 2 ;;
    --seed) first_seed=${2:?--seed needs a number}; shift 2 ;;
    --size) size=${2:?--size needs WIDTHxHEIGHT}; shift 2 ;;
    --parts) shift; while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do parts+=("$(absolute "$1")"); shift; done ;;
    -o) out=$(absolute "${2:?-o needs a folder}"); shift 2 ;;
    --) shift; break ;;
    *) fail "unknown option '$1'; see benchmark/regression.sh --help" ;;
  esac
done
case "$bins" in ''|*[!0-9]*|0) fail "--bins is '$bins', but it must be a whole number from 1" ;; esac
case "$first_seed" in ''|*[!0-9]*) fail "--seed is '$first_seed', but it must be a whole number from 0" ;; esac
if [ ${#parts[@]} -eq 0 ]; then
  for file in "$source_dir"/config/parts/*/part.yaml; do parts+=("$(dirname "$file")"); done
fi
program=$(dirname "$build_dir")/devel/lib/bin_picking_perception/bin_picking
[ -x "$program" ] || program=$build_dir/devel/lib/bin_picking_perception/bin_picking
[ -x "$program" ] || program=$build_dir/bin_picking
[ -x "$program" ] || fail "no bin_picking beside $build_dir; run scripts/build.sh first"

set=$out/set
partial=$out/making
mkdir -p "$set/parts" "$partial"

# Simulates into a folder of its own and moves the scenes into the set, named KIND_PART_NUMBER.
make_scenes() {  # KIND PART_NAME SCENES SEED PART_DIR... [-- SIMULATE_OPTION...]
  local kind=$1 name=$2 scenes=$3 seed=$4; shift 4
  local last part scene
  last=$set/${kind}_${name}_$(printf %04d "$scenes")
  if [ -e "$last" ]; then return; fi
  local made=$partial/${kind}_$name
  "$program" simulate "$@" --scenes "$scenes" --seed "$seed" --sensor "$sensor" --size "$size" -o "$made" >/dev/null
  for part in "$made"/parts/*; do
    rm -rf "$set/parts/${part##*/}"
    mv "$part" "$set/parts/"
  done
  rmdir "$made/parts"
  if [ "$scenes" -eq 1 ]; then
    mv "$made" "$last"
  else
    for scene in "$made"/scene_*; do rm -rf "$set/${kind}_${name}_${scene##*_}"; mv "$scene" "$set/${kind}_${name}_${scene##*_}"; done
    rmdir "$made"
  fi
}

# What the set was made with; another choice makes another set.
choice="$bins $sensor $size $first_seed $(cd "$source_dir" && for part in "${parts[@]}"; do cat "$part"/* | cksum; done | cksum) $(cksum <"$program")"
if [ "$(cat "$out/choice" 2>/dev/null)" != "$choice" ]; then
  rm -rf "$set" "$partial"
  mkdir -p "$set/parts" "$partial"
  echo "$choice" >"$out/choice"
fi

count=${#parts[@]}
for ((k = 0; k < count; ++k)); do
  part=${parts[k]}
  other=${parts[(k + 1) % count]}
  name=${part##*/}
  seed=$((first_seed + 1000 * (k + 1)))
  echo "regression: $((k + 1)) of $count: $name" >&2
  make_scenes full "$name" "$bins" "$seed" "$part" --count 25
  make_scenes single "$name" 1 $((seed + 500)) "$part" --count 1
  make_scenes empty "$name" 1 $((seed + 600)) "$part" --empty
  if [ "$part" != "$other" ]; then
    make_scenes other "$name" 1 $((seed + 700)) "$part" "$other" --count 0 25
  fi
done
rm -rf "$partial"

"$program" evaluate --dataset "$set" --cache "$out/models" --json "$out/report.json" --html "$out/report.html" "$@" |
  tee "$out/report.txt"
echo "regression: a picture of every scene: $out/report.html"
