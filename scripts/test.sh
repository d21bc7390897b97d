#!/usr/bin/env bash
# Installs what is missing, builds, runs all tests. Ends with ctest's summary and returns its exit code.
# Usage: scripts/test.sh [CTEST_OPTION...]      e.g. scripts/test.sh -R grasp
#   BUILD_DIR=DIR    build folder (default: build)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build_dir=${BUILD_DIR:-build}
scripts/setup.sh
scripts/build.sh
export ROS_HOME="$PWD/$build_dir/ros_home"  # keeps ROS logs out of the home folder
case "$build_dir" in /*) ROS_HOME="$build_dir/ros_home" ;; esac
cd "$build_dir"
exec ctest --output-on-failure -j "$(nproc)" "$@"
