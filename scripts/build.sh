#!/usr/bin/env bash
# Configures (when needed) and builds a preset of CMakePresets.json, all of it or some targets. Shows how far it is on
# standard error; the rest is in build/PRESET.log and shown if it fails. The presets with MPI have the Debian packages
# that they need installed first. Usage: build.sh PRESET [TARGET...]
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

(($# > 0)) || { echo 'usage: build.sh PRESET [TARGET...]' >&2; exit 1; }
preset=$1
shift
[[ $preset != mpi && $preset != contracted ]] || scripts/setup.sh build mpi
folder=build/$preset
log=build/$preset.log
mkdir -p build

# A folder that was configured for another place, or whose configuration failed, is made anew: CMake refuses the one,
# and goes on in the other without the flags of a compiler that was missing.
configure() {
   if [[ -f $folder/build.ninja ]]; then
      grep --quiet --line-regexp --fixed-strings "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$folder/CMakeCache.txt" && return
      echo "build.sh: $folder was made for another folder than $PWD, it is made anew." >&2
   fi
   rm -rf "$folder"
   cmake --preset "$preset" &>"$log" && return
   rm -rf "$folder"
   return 1
}

build() {
   local targets=()
   (($# == 0)) || targets=(--target "$@")
   NINJA_STATUS='[%f/%t] ' cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}" 2>&1 |
      scripts/helpers/progress.sh "$log" "$preset"
}

{ configure && build "$@"; } || { cat "$log" >&2; exit 1; }
