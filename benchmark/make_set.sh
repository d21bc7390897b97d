# shellcheck shell=bash
# Functions that the benchmarks share; to be sourced, from any folder. The caller defines fail() and sets start_dir.
# Virtual bins are made once from seeds, bit for bit the same on every run, and made anew when what they follow from has
# changed.

source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build_dir=${BUILD_DIR:-build}
case "$build_dir" in /*) ;; *) build_dir=$source_dir/$build_dir ;; esac

# Without the slash that a shell's */ leaves behind, for the last name of the path is used.
absolute() { set -- "${1%/}"; case "$1" in /*) echo "$1" ;; *) echo "$start_dir/$1" ;; esac; }

require_number() {  # OPTION VALUE LOWEST
  case "$2" in ''|*[!0-9]*) fail "$1 is '$2', but it must be a whole number from $3" ;; esac
  [ "$2" -ge "$3" ] || fail "$1 is '$2', but it must be a whole number from $3"
}

# Sets program: bin_picking as it was built in build_dir, with catkin or without.
find_program() {
  local place
  for place in "$(dirname "$build_dir")/devel" "$build_dir/devel"; do
    program=$place/lib/bin_picking_perception/bin_picking
    if [ -x "$program" ]; then return; fi
  done
  program=$build_dir/bin_picking
  [ -x "$program" ] || fail "no bin_picking beside $build_dir; run scripts/build.sh first, or set BUILD_DIR"
}

# Prints the parts that were asked for, or all of config/parts.
part_folders() {  # [PART_DIR...]
  local file
  if [ $# -gt 0 ]; then printf '%s\n' "$@"; return; fi
  for file in "$source_dir"/config/parts/*/part.yaml; do dirname "$file"; done
}

# Sets set_dir, empty if it was made with another choice than this, other parts or another simulation.
open_set() {  # DIR CHOICE PART_DIR...
  local folder=$1 choice=$2; shift 2
  choice+=" $(for part in "$@"; do cat "$part"/* | cksum; done | cksum)"
  choice+=" $(cat "$source_dir"/src/simulation/* | cksum)"
  set_dir=$folder/set
  if [ "$(cat "$folder/choice" 2>/dev/null)" != "$choice" ]; then
    rm -rf "$set_dir" "$folder/making"
    mkdir -p "$folder"
    echo "$choice" >"$folder/choice"
  fi
  mkdir -p "$set_dir/parts" "$folder/making"
}

close_set() { rm -rf "${set_dir%/set}/making"; }

# Simulates into a folder of its own and moves the scenes into the set, named KIND_PART_NUMBER.
make_scenes() {  # KIND PART_NAME SCENES SEED SENSOR SIZE PART_DIR... [SIMULATE_OPTION...]
  local kind=$1 name=$2 scenes=$3 seed=$4 sensor=$5 size=$6; shift 6
  local last made part scene
  last=$set_dir/${kind}_${name}_$(printf %04d "$scenes")
  if [ -e "$last" ]; then return; fi
  made=${set_dir%/set}/making/${kind}_$name
  "$program" simulate "$@" --scenes "$scenes" --seed "$seed" --sensor "$sensor" --size "$size" -o "$made" >/dev/null
  for part in "$made"/parts/*; do
    rm -rf "$set_dir/parts/${part##*/}"
    mv "$part" "$set_dir/parts/"
  done
  rmdir "$made/parts"
  if [ "$scenes" -eq 1 ]; then
    mv "$made" "$last"
    return
  fi
  for scene in "$made"/scene_*; do
    rm -rf "$set_dir/${kind}_${name}_${scene##*_}"
    mv "$scene" "$set_dir/${kind}_${name}_${scene##*_}"
  done
  rmdir "$made"
}

# Prints a folder for trained models, emptied when the code that trains has changed: models are told apart by part and
# parameters, not by the code.
models_folder() {  # DIR
  local library code
  library=$(ldd "$program" | sed -n 's/.*libbin_picking_core[^ ]* => \([^ ]*\).*/\1/p')
  code=$(cksum <"${library:-$program}")
  if [ "$(cat "$1/code" 2>/dev/null)" != "$code" ]; then
    rm -rf "$1"
    mkdir -p "$1"
    echo "$code" >"$1/code"
  fi
  echo "$1"
}
