#!/usr/bin/env bash
# Proves that the package also builds and passes its tests inside a catkin workspace, and that its install space works.
# Usage: scripts/test_catkin.sh [WORKSPACE]      default: a temporary folder, removed afterwards
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

if [ $# -gt 0 ]; then
  mkdir -p "$1"
  workspace=$(cd "$1" && pwd)
else
  workspace=$(mktemp -d)
  trap 'rm -rf "$workspace"' EXIT
fi
# catkin takes the first python3 of PATH; only the system's one has its modules.
export PATH=/usr/bin:$PATH
export ROS_HOME="$workspace/ros_home"
"$source_dir/scripts/setup.sh"

mkdir -p "$workspace/src"
ln -sfn "$source_dir" "$workspace/src/bin_picking_perception"
cd "$workspace"
memory_gb=$(awk '/MemAvailable/ { print int($2 / 1048576) }' /proc/meminfo)
jobs=$(nproc)
[ "$memory_gb" -ge "$jobs" ] || jobs=$((memory_gb > 1 ? memory_gb : 1))
# Twice: catkin records the test environment while configuring and leaves out folders that do not exist yet.
catkin_make -j"$jobs" -DCMAKE_BUILD_TYPE=Release
catkin_make -j"$jobs" -DCMAKE_BUILD_TYPE=Release
catkin_make -j"$jobs" tests
# catkin_make run_tests returns 0 even if tests fail; ctest does not.
(cd build && ctest --output-on-failure)
catkin_make -j"$jobs" install

set +u  # ROS's setup files read variables that are not set
. install/setup.sh
set -u
rospack plugins --attrib=plugin nodelet | grep bin_picking_perception
rosmsg show bin_picking_perception/Grasp >/dev/null
rossrv show bin_picking_perception/GetBestGrasp >/dev/null
rosrun bin_picking_perception bin_picking --version
echo "test_catkin: build, tests and install space are right"
