#!/usr/bin/env bash
# Feeds the program with spoilt decks, meshes and reduced problems; whatever it does but solve or refuse them with a
# sentence is an error. The spoilt files are the same in every run. Usage: fuzz.sh [COUNT [FIRST]]
#   COUNT    spoilt files of each format, 10000 by default; half of them meet the sanitizers, half a memory limit
#   FIRST    number of the first one, 0 by default
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

count=${1:-10000}
first=${2:-0}
scripts/setup.sh build
for preset in sanitize debug; do
   scripts/build.sh "$preset"
done
half=$(((count + 1) / 2))
status=0
for format in deck gmsh abaqus reduced; do
   python3 -B scripts/fuzz.py build/sanitize/bin/amontons "$format" "$half" "$first" || status=1
   python3 -B scripts/fuzz.py build/debug/bin/amontons "$format" "$((count - half))" "$((first + half))" || status=1
done
exit "$status"
