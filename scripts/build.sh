#!/usr/bin/env bash
# Configures (when needed) and builds a preset of CMakePresets.json; silent unless it fails. The preset mpi has the
# Debian packages it needs installed first. Usage: build.sh PRESET
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

preset=${1:?usage: build.sh PRESET}
[[ $preset != mpi ]] || scripts/setup.sh build mpi
mkdir -p build
log=build/$preset.log

build() {
   [[ -f build/$preset/build.ninja ]] || cmake --preset "$preset" || return
   cmake --build --preset "$preset" --parallel "$(nproc)"
}

build &>"$log" || { cat "$log" >&2; exit 1; }
