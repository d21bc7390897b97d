#!/usr/bin/env bash
# The fixed regression set: every part of config/parts in virtual bins, made anew from seeds where it is not there yet,
# and one table of how well they are found. Bit for bit the same set on every run.
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
fail() { echo "regression: $*" >&2; exit 2; }
. "$(dirname "${BASH_SOURCE[0]}")/make_set.sh"

bins=4
sensor=structured_light
size=1280x1024
first_seed=0
parts=()
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
require_number --bins "$bins" 1
require_number --seed "$first_seed" 0
mapfile -t parts < <(part_folders ${parts[@]+"${parts[@]}"})
find_program

open_set "$out" "$bins $sensor $size $first_seed" "${parts[@]}"
count=${#parts[@]}
for ((k = 0; k < count; ++k)); do
  part=${parts[k]}
  other=${parts[(k + 1) % count]}
  name=${part##*/}
  seed=$((first_seed + 1000 * (k + 1)))
  echo "regression: $((k + 1)) of $count: $name" >&2
  make_scenes full "$name" "$bins" "$seed" "$sensor" "$size" "$part" --count 25
  make_scenes single "$name" 1 $((seed + 500)) "$sensor" "$size" "$part" --count 1
  make_scenes empty "$name" 1 $((seed + 600)) "$sensor" "$size" "$part" --empty
  if [ "$part" != "$other" ]; then
    make_scenes other "$name" 1 $((seed + 700)) "$sensor" "$size" "$part" "$other" --count 0 25
  fi
done
close_set

"$program" evaluate --dataset "$set_dir" --cache "$(models_folder "$out/models")" --json "$out/report.json" \
  --html "$out/report.html" "$@" | tee "$out/report.txt"
echo "regression: a picture of every scene: $out/report.html"
