#!/usr/bin/env bash
# The experiments of Cui et al. 2022 (Cur-PPF), run again: every table and figure beside the paper's own figures.
# Usage: benchmark/paper.sh --data DIR [-o OUT] [--only TABLE...] [--quick] [OPTION...]; --help lists all options
#   BUILD_DIR=DIR  build folder (default: build)
# Writes OUT/report.html (one page that needs nothing else) and OUT/report.md. What is finished is kept in OUT: a run
# that was broken off goes on where it stopped. Run it on a machine that does nothing else: the report says how busy it
# was.
set -euo pipefail
start_dir=$PWD
fail() { echo "paper: $*" >&2; exit 2; }
. "$(dirname "${BASH_SOURCE[0]}")/make_set.sh"

case " $* " in
  *" -h "*|*" --help "*)
    sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
    exec "$source_dir/benchmark/paper/run.py" --program - --experiment - --package - --help ;;
esac
find_program
experiment=$build_dir/benchmark_paper
[ -x "$experiment" ] || fail "no $experiment; run scripts/build.sh first, or set BUILD_DIR"
version=$(git -C "$source_dir" describe --always --dirty 2>/dev/null || echo "no repository")
out=$build_dir/paper
arguments=()
while [ $# -gt 0 ]; do
  case "$1" in
    -o) out=$(absolute "${2:?-o needs a folder}"); shift 2 ;;
    --picking)
      arguments+=("$1"); shift
      while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do arguments+=("$(absolute "$1")"); shift; done ;;
    --data|--dataset|--config|--write) arguments+=("$1" "$(absolute "${2:?$1 needs a path}")"); shift 2 ;;
    *) arguments+=("$1"); shift ;;
  esac
done
models_folder "$out/models" >/dev/null
code=$(cat "$out/models/code" "$program" "$experiment" | cksum)  # figures of other code are not kept
exec "$source_dir/benchmark/paper/run.py" --program "$program" --experiment "$experiment" --package "$source_dir" \
  --version "$version" --code "$code" -o "$out" ${arguments[@]+"${arguments[@]}"}
