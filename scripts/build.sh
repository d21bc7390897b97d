#!/usr/bin/env bash
# Builds everything, tests included: Release, warnings are errors, no workspace needed.
# Usage: scripts/build.sh [--lenient] [CMAKE_OPTION...]      e.g. scripts/build.sh -DBIN_PICKING_WITH_ROS=OFF
#   --lenient        warnings are not errors (for other compilers than GCC 12)
#   BUILD_DIR=DIR    build folder (default: build)
#   DEVEL_DIR=DIR    where setup.sh, programs and messages go (default: devel beside the build folder)
#   JOBS=N           compilers at once (default: by processors and free memory)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build_dir=${BUILD_DIR:-build}
# Beside the build folder: rosrun leaves out whatever lies below PACKAGE/build, and sees catkin's copies elsewhere twice.
devel_dir=${DEVEL_DIR:-$(dirname "$build_dir")/devel}
case "$devel_dir" in /*) ;; *) devel_dir=$PWD/$devel_dir ;; esac
werror=ON
case "${1:-}" in
  -h|--help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"; exit 0 ;;
  --lenient) werror=OFF; shift ;;
esac

# Translation units with PCL take about 1 GB each.
memory_gb=$(awk '/MemAvailable/ { print int($2 / 1048576) }' /proc/meminfo)
jobs=$(nproc)
[ "$memory_gb" -ge "$jobs" ] || jobs=$((memory_gb > 1 ? memory_gb : 1))
jobs=${JOBS:-$jobs}

launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache)

cmake -S . -B "$build_dir" -DCMAKE_BUILD_TYPE=Release -DBIN_PICKING_WERROR=$werror \
  -DCATKIN_DEVEL_PREFIX="$devel_dir" "${launcher[@]}" "$@"
targets=(all)
# catkin keeps the ROS tests out of "all".
known=$(cmake --build "$build_dir" --target help)
if grep -qx '\.\.\. tests' <<<"$known"; then targets+=(tests); fi
echo "build: $jobs at once"
cmake --build "$build_dir" -j "$jobs" --target "${targets[@]}"
