#!/usr/bin/env bash
# Builds the core and its tests with the address and undefined-behaviour sanitizers and runs them.
# Usage: scripts/sanitize.sh [CTEST_OPTION...]
#   SANITIZER=thread    looks for data races instead
#   BUILD_DIR=DIR       build folder (default: build-sanitize-SANITIZER)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

sanitizer=${SANITIZER:-address,undefined}
build_dir=${BUILD_DIR:-build-sanitize-${sanitizer%%,*}}
# Under ASan Eigen would choose another allocator than the PCL library was built with.
flags="-fsanitize=$sanitizer -fno-sanitize-recover=undefined -fno-omit-frame-pointer -O1 -g"
flags+=" -DEIGEN_MALLOC_ALREADY_ALIGNED=1"

BUILD_DIR=$build_dir scripts/build.sh --lenient -DBIN_PICKING_WITH_ROS=OFF -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS="$flags"
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
# The runtime keeps several times the memory of the program: one test at a time, and patience.
cd "$build_dir"
exec ctest --output-on-failure --timeout 1500 "$@"
