#!/usr/bin/env bash
# Fits the weights of the score (src/core/refinement/confidence_weights.hpp) to all poses that are tested in the scenes of
# a set, right and wrong, and says how well they do, also on scenes and on parts that they were not fitted to.
# Usage: benchmark/fit_confidence.sh SET_DIR [OPTION...] [-- EVALUATE_OPTION...]
#   SET_DIR          scenes with truth and the folder parts, as benchmark/regression.sh makes them; fit on other seeds
#                    (--seed) than figures are reported on
#   --write          write the weights into the source; build again to use them
#   --origin TEXT    what the set is, for the source's comment (default: the set's name)
#   -o DIR           where models and report go (default: BUILD_DIR/fit_confidence)
#   BUILD_DIR=DIR    build folder (default: build)
# Writes DIR/report.{json,txt}.
set -euo pipefail
start_dir=$PWD
fail() { echo "fit_confidence: $*" >&2; exit 2; }
. "$(dirname "${BASH_SOURCE[0]}")/make_set.sh"

out=$build_dir/fit_confidence
set_dir=
origin=
write=()
while [ $# -gt 0 ]; do
  case "$1" in
    -h|--help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    --write) write=(--write "$source_dir/src/core/refinement/confidence_weights.hpp"); shift ;;
    --origin) origin=${2:?--origin needs words}; shift 2 ;;
    -o) out=$(absolute "${2:?-o needs a folder}"); shift 2 ;;
    --) shift; break ;;
    -*) fail "unknown option '$1'; see benchmark/fit_confidence.sh --help" ;;
    *) [ -z "$set_dir" ] || fail "one SET_DIR is enough, but '$1' is another"; set_dir=$(absolute "$1"); shift ;;
  esac
done
[ -n "$set_dir" ] || fail "say which set: benchmark/fit_confidence.sh SET_DIR; benchmark/regression.sh makes one"
[ -d "$set_dir" ] || fail "$set_dir is no folder"
find_program
mkdir -p "$out"
"$program" evaluate --dataset "$set_dir" --cache "$(models_folder "$out/models")" --json "$out/report.json" "$@" \
  --set max_rejected=1000 >/dev/null
"$source_dir/benchmark/fit_confidence.py" "$out/report.json" --origin "${origin:-$(basename "$set_dir")}" \
  ${write[@]+"${write[@]}"} | tee "$out/report.txt"
