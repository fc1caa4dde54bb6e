#!/usr/bin/env bash
# Runs every contact method on Table 1's rows on 16 to 128 segments, measures the condition of the paper's matrices, and
# prints both as tables in Markdown. Installs and builds what is missing. Usage: compare_methods.sh [--update]
#   --update    writes the tables, shortened, into doc/methods.md, between the markers, and the figure into doc/images
# Leaves build/methods/tables with every row, runs.csv, one line for each run, and methods.png and .svg beside it.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

is_update=false
case ${1-} in
   '') ;;
   --update) is_update=true ;;
   *)
      sed -n '2,/^set/{s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}" >&2
      exit 1
      ;;
esac

scripts/setup.sh build >&2
scripts/build.sh release amontons_app

output=build/methods
rm -rf "$output"
mkdir -p "$output"
AMONTONS=$PWD/build/release/bin/amontons OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 \
   scripts/python.sh scripts/helpers/compare_methods.py "$output" "$output"/methods.{png,svg} >"$output/tables"
echo >>"$output/tables"
cat "$output/tables"

if $is_update; then
   # The page has the finest mesh of quadrilaterals, held by contact alone.
   awk '/^### / { is_left_out = /^### (tri3,|quad4, pinned)/ } !is_left_out && !/^\| [^|]+ \| (16|32|64) \|/' \
      "$output/tables" >"$output/digest"
   # Everything after the first marker and before the second is replaced.
   sed -i -e "/<!-- compare_methods.sh -->/r $output/digest" \
      -e '/<!-- compare_methods.sh -->/,/<!-- end -->/{/<!--/!d}' doc/methods.md
   cp "$output/methods.png" doc/images/
fi
