#!/usr/bin/env bash
# The whole loop without hardware: fills a virtual bin, finds the parts on the command line and through the ROS nodes, asks
# for the best grasp and holds the answer against the truth. Opens rviz where there is a display.
# Usage: scripts/demo.sh [OPTION...]
#   --part DIR               folder with part.yaml (default: config/parts/three_way_tube)
#   --seed N                 another bin (default: 1)
#   --pick-all               afterwards empties the bin, part by part, as the detector says
#   --by truth               with --pick-all: as the truth says (default: detector)
#   --headless               no rviz, even with a display
#   --rviz-screenshot FILE   renders rviz on a virtual display into a PNG
#   BUILD_DIR=DIR            build folder (default: build); the demo's files go to BUILD_DIR/demo
# Exit code 1 if the part of the best grasp is off by more than 5 mm or 5 degrees, or if --pick-all leaves parts.
set -euo pipefail
start_dir=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source_dir=$PWD

fail() { echo "demo: $*" >&2; exit 1; }
log() { echo; echo "demo: $*"; }
absolute() { case "$1" in /*) echo "$1" ;; *) echo "$start_dir/$1" ;; esac; }

part=$source_dir/config/parts/three_way_tube
seed=1
screenshot=
pick_all=
pick_by=detector
rviz=${DISPLAY:+true}
while [ $# -gt 0 ]; do
  case "$1" in
    -h|--help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    --headless) rviz=; shift ;;
    --pick-all) pick_all=true; shift ;;
    --by) pick_by=${2:?--by needs detector or truth}; shift 2 ;;
    --part) part=$(absolute "${2:?--part needs a folder}"); shift 2 ;;
    --seed) seed=${2:?--seed needs a number}; shift 2 ;;
    --rviz-screenshot) screenshot=$(absolute "${2:?--rviz-screenshot needs a file}"); rviz=; shift 2 ;;
    *) echo "demo: unknown option '$1'; see scripts/demo.sh --help" >&2; exit 2 ;;
  esac
done

build_dir=${BUILD_DIR:-build}
case "$build_dir" in /*) ;; *) build_dir=$source_dir/$build_dir ;; esac
devel_dir=$(dirname "$build_dir")/devel
scripts/setup.sh
DEVEL_DIR=$devel_dir scripts/build.sh
out=$build_dir/demo
scene=$out/scene
mkdir -p "$out"

set +u  # ROS's setup files read variables that are not set
# shellcheck disable=SC1091
. "$devel_dir/setup.sh"
set -u
# Other python3 than the system's, first on PATH, lack ROS's modules.
export PATH="$devel_dir/lib/bin_picking_perception:/usr/bin:$PATH"
command -v bin_picking >/dev/null || fail "the build left no bin_picking in $devel_dir."

log "a scan of a virtual bin as files, seed $seed"
bin_picking simulate "$part" --seed "$seed" -o "$scene"

log "training and detection on the command line"
bin_picking train "$part" -o "$out/part.model"
bin_picking detect --model "$out/part.model" --cloud "$scene/scene.pcd" --bin "$scene/bin.yaml" \
  --json "$out/detections.json" --image "$out/detections.png"

log "the same through ROS, in a running virtual cell: roslaunch bin_picking_perception demo.launch"
port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1 ROS_HOME=$out/ros_home
unset ROS_HOSTNAME
children=()
# roslaunch stops its nodes on SIGINT, which shells make background jobs ignore; SIGTERM does the same to it.
stop() {
  local pid
  for pid in "${children[@]}"; do kill -TERM "$pid" 2>/dev/null || true; done
  for pid in "${children[@]}"; do wait "$pid" 2>/dev/null || true; done
}
trap stop EXIT
roslaunch -p "$port" bin_picking_perception demo.launch parts:="$part" seed:="$seed" rviz:="${rviz:-false}" \
  >"$out/roslaunch.log" 2>&1 &
children+=($!)
for _ in $(seq 120); do  # until the master listens
  if (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; then break; fi
  sleep 0.5
done

failed=0
/usr/bin/python3 scripts/demo_report.py "$part" || failed=1
[ $failed -eq 0 ] || echo "demo: the log of the nodes is $out/roslaunch.log" >&2

if [ -n "$screenshot" ]; then
  log "rviz on a virtual display"
  screen=77
  while [ -e "/tmp/.X11-unix/X$screen" ] || [ -e "/tmp/.X$screen-lock" ]; do screen=$((screen + 1)); done
  XDG_RUNTIME_DIR=$(mktemp -d)
  export XDG_RUNTIME_DIR DISPLAY=:$screen LIBGL_ALWAYS_SOFTWARE=1 QT_X11_NO_MITSHM=1
  Xvfb ":$screen" -screen 0 1280x800x24 +extension GLX -nolisten tcp >"$out/xvfb.log" 2>&1 &
  children+=($!)
  sleep 2
  rviz -d config/rviz/bin_picking.rviz --no-stereo >"$out/rviz.log" 2>&1 &
  children+=($!)
  # Nothing tells that rviz has subscribed and drawn everything; a software renderer takes its time with a large cloud.
  sleep 15
  /usr/bin/python3 scripts/pick_client.py >"$out/pick_client.log"  # pictures of the segmentation are only made while somebody looks
  sleep 25
  import -window root "$screenshot"
  echo "demo: $screenshot"
fi

if [ -n "$pick_all" ]; then
  log "emptying the bin, best part first as the $pick_by says"
  /usr/bin/python3 scripts/empty_bin.py --by "$pick_by" || failed=1
fi

log "the picture of what was found: $out/detections.png"
if [ -n "$rviz" ]; then
  echo "demo: rviz shows the same; Ctrl-C ends"
  wait "${children[0]}" || true
fi
exit $failed
