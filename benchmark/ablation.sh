#!/usr/bin/env bash
# What each ingredient of training and detection buys: each is switched off or replaced, one at a time, on one data set,
# and held against the default that runs before and after it, in one table.
# Usage: benchmark/ablation.sh SET_DIR [OPTION...]
#   SET_DIR          scenes with truth and the folder parts, as benchmark/regression.sh makes them; choose settings on
#                    other seeds (--seed) than figures are reported on
#   --only REGEX     only lines of benchmark/ablation.txt that contain this
#   --parts NAME...  only these parts of the set
#   --max-scenes N   only the first so many scenes
#   --threads N      of the detector (default: 1)
#   --repeat N       timed runs per scene (default: 1)
#   --preset NAME    what the default is (default: fast)
#   -o DIR           where models and report go (default: BUILD_DIR/ablation)
#   BUILD_DIR=DIR    build folder (default: build)
# Writes DIR/report.{md,json}.
set -euo pipefail
start_dir=$PWD
fail() { echo "ablation: $*" >&2; exit 2; }
. "$(dirname "${BASH_SOURCE[0]}")/make_set.sh"

out=$build_dir/ablation
options=()
set_dir=
while [ $# -gt 0 ]; do
  case "$1" in
    -h|--help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    -o) out=$(absolute "${2:?-o needs a folder}"); shift 2 ;;
    --parts) options+=("$1"); shift; while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do options+=("$1"); shift; done ;;
    --only|--max-scenes|--threads|--repeat|--preset) options+=("$1=${2:?$1 needs a value}"); shift 2 ;;
    -*) fail "unknown option '$1'; see benchmark/ablation.sh --help" ;;
    *) [ -z "$set_dir" ] || fail "one SET_DIR is enough, but '$1' is another"; set_dir=$(absolute "$1"); shift ;;
  esac
done
[ -n "$set_dir" ] || fail "say which set: benchmark/ablation.sh SET_DIR; benchmark/regression.sh makes one"
[ -d "$set_dir" ] || fail "$set_dir is no folder"
find_program
mkdir -p "$out"
version=$(git -C "$source_dir" describe --always --dirty 2>/dev/null || echo "no repository")
"$source_dir/benchmark/ablation.py" "$set_dir" --program "$program" --models "$(models_folder "$out/models")" \
  --output "$out" --version "$version" ${options[@]+"${options[@]}"} | tee "$out/report.md"
