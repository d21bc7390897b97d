#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) over our sources. Needs a configured build folder for the compile commands.
# Usage: scripts/tidy.sh [FILE...]      without files: everything under src
#   BUILD_DIR=DIR    build folder (default: build)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build_dir=${BUILD_DIR:-build}
command -v clang-tidy >/dev/null || { echo "tidy: clang-tidy is missing: apt-get install clang-tidy" >&2; exit 1; }
[ -f "$build_dir/compile_commands.json" ] ||
  { echo "tidy: $build_dir/compile_commands.json is missing: run scripts/build.sh first" >&2; exit 1; }

if [ $# -gt 0 ]; then
  files=("$@")
else
  # Only what the build compiles: compile_commands.json knows nothing of the rest.
  mapfile -t files < <(git ls-files 'src/*.cpp' | while read -r file; do
    grep -q "/$file\"" "$build_dir/compile_commands.json" && echo "$file"; done)
fi
echo "tidy: ${#files[@]} files"
# -Wno-unknown-warning-option: the commands are GCC's.
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" \
  clang-tidy --quiet -p "$build_dir" --extra-arg=-Wno-unknown-warning-option
