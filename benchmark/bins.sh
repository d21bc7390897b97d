#!/usr/bin/env bash
# How long detection takes in full bins of 25, stage by stage, for every part, picture size and number of threads: from
# the cloud in memory to ranked, verified detections. Recall and precision stand beside it, so that no time is bought
# with parts that are not found.
# Usage: benchmark/bins.sh [OPTION...] [-- EVALUATE_OPTION...]
#   --bins N         bins per part, each with other seeds (default: 2)
#   --repeat N       timed runs per bin (default: 5)
#   --sizes WxH...   pixels of the camera, over the same field of view (default: 640x512 1280x1024 1700x1360)
#   --threads N...   numbers of threads (default: 1 2)
#   --parts DIR...   other parts than those of config/parts
#   --seed N         first seed (default: 0)
#   -o DIR           where sets and report go (default: BUILD_DIR/bins)
#   BUILD_DIR=DIR    build folder (default: build)
# Writes DIR/report.{md,json}. Run it on a machine that does nothing else: the report says how busy it was.
# What follows -- goes to `bin_picking evaluate`: --preset accurate, --set key=value, ...
set -euo pipefail
start_dir=$PWD
fail() { echo "bins: $*" >&2; exit 2; }
. "$(dirname "${BASH_SOURCE[0]}")/make_set.sh"

bins=2
repeat=5
sizes=()
threads=()
parts=()
first_seed=0
out=$build_dir/bins
while [ $# -gt 0 ]; do
  case "$1" in
    -h|--help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    --bins) bins=${2:?--bins needs a number}; shift 2 ;;
    --repeat) repeat=${2:?--repeat needs a number}; shift 2 ;;
    --seed) first_seed=${2:?--seed needs a number}; shift 2 ;;
    --sizes) shift; while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do sizes+=("$1"); shift; done ;;
    --threads) shift; while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do threads+=("$1"); shift; done ;;
    --parts) shift; while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do parts+=("$(absolute "$1")"); shift; done ;;
    -o) out=$(absolute "${2:?-o needs a folder}"); shift 2 ;;
    --) shift; break ;;
    *) fail "unknown option '$1'; see benchmark/bins.sh --help" ;;
  esac
done
require_number --bins "$bins" 1
require_number --repeat "$repeat" 1
require_number --seed "$first_seed" 0
[ ${#sizes[@]} -gt 0 ] || sizes=(640x512 1280x1024 1700x1360)
[ ${#threads[@]} -gt 0 ] || threads=(1 2)
for number in "${threads[@]}"; do require_number --threads "$number" 1; done
mapfile -t parts < <(part_folders ${parts[@]+"${parts[@]}"})
find_program

mkdir -p "$out"
cp /proc/loadavg "$out/load"  # before work of our own adds to it

for size in "${sizes[@]}"; do
  open_set "$out/$size" "$bins structured_light $size $first_seed" "${parts[@]}"
  for ((k = 0; k < ${#parts[@]}; ++k)); do
    name=${parts[k]##*/}
    echo "bins: $size: $name" >&2
    make_scenes full "$name" "$bins" $((first_seed + 1000 * (k + 1))) structured_light "$size" "${parts[k]}" --count 25
  done
  close_set
done

models=$(models_folder "$out/models")
# Models are trained before the clock starts; threads change the time, not the result.
"$program" evaluate --dataset "$set_dir" --cache "$models" "$@" >/dev/null
TIMEFORMAT='%R %U %S'
runs=()
for size in "${sizes[@]}"; do
  for number in "${threads[@]}"; do
    echo "bins: $size, threads: $number" >&2
    run=$out/${size}_$number
    head -1 /proc/stat >"$run.before"
    { time "$program" evaluate --dataset "$out/$size/set" --cache "$models" --threads "$number" --repeat "$repeat" \
        --json "$run.json" "$@" >"$run.txt"; } 2>"$run.time" || { cat "$run.time" >&2; exit 1; }
    head -1 /proc/stat >"$run.after"
    runs+=("$run")
  done
done

version=$(git -C "$source_dir" describe --always --dirty 2>/dev/null || echo "no repository")
"$source_dir/benchmark/bins_report.py" --version "$version" --options "$*" --load "$out/load" \
  --json "$out/report.json" "${runs[@]}" | tee "$out/report.md"
