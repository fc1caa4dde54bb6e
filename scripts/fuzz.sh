#!/usr/bin/env bash
# Feeds the program with spoiled decks, meshes, tables, reduced problems and command lines; whatever it does but solve
# or refuse them with a sentence is an error. Then solves random sound bodies by two routes, which must agree, and a
# tenth as many bodies of all kinds turned, mirrored, in other units and renumbered. Files and bodies are the same in
# every run. Usage: fuzz.sh [COUNT [FIRST]]
#   COUNT    spoiled files of each format (a tenth as many command lines), and bodies, 10000 by default. One file in ten
#            meets the sanitizers, the others a memory limit and the run-time checks of the debug build
#   FIRST    number of the first one, 0 by default
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

count=${1:-10000}
first=${2:-0}
for number in "$count" "$first"; do
   if [[ ! $number =~ ^[0-9]+$ ]]; then
      echo "fuzz.sh: expected a number of files, found '$number'" >&2
      exit 1
   fi
done
round=10000
scripts/setup.sh build
for preset in sanitize debug release; do
   scripts/build.sh "$preset" amontons_app
done
status=0
fuzz() { (($3 == 0)) || python3 -B scripts/dev/fuzz.py "build/$1/bin/amontons" "$2" "$3" "$4" || status=1; }
for ((done = 0; done < count; done += round)); do
   n=$((count - done < round ? count - done : round))
   start=$((first + done))
   for format in deck gmsh_2 gmsh_2_binary gmsh_4 gmsh_4_binary abaqus table reduced; do
      fuzz sanitize "$format" $((n / 10)) "$start"
      fuzz debug "$format" $((n - n / 10)) $((start + n / 10))
   done
   fuzz debug command $((n / 10)) "$start"
done
((count == 0)) || python3 -B scripts/dev/fuzz_bodies.py build/release/bin/amontons "$count" "$first" || status=1
((count < 10)) || python3 -B scripts/dev/fuzz_frames.py build/release/bin/amontons $((count / 10)) "$first" || status=1
exit "$status"
