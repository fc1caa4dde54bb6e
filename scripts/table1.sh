#!/usr/bin/env bash
# Table 1 of Pop and Zelina (2005) beside what the program computes. Installs and builds what is missing.
# Usage: table1.sh [--method NAME] [--variant NAME] [--element NAME] [--accuracy] [--figure]
#   --method    auto (default), newton, splitting, fixed_point, psor, lemke
#   --variant   of splitting: exact (default), clip, printed
#   --element   quad4 (default), tri3
#   --accuracy  prints the lengths on four refined meshes with error bars as well
#   --figure    draws bar, loads, zones and the map of states: build/table1/figure.png and .svg
# Exit status: 0 if every transition lies within one segment (1.25 mm) of the paper's and every certificate passes.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

method=auto variant=exact element=quad4 is_accuracy=false is_figure=false
while (($# > 0)); do
   case $1 in
      --method | --variant | --element)
         (($# > 1)) || { echo "table1.sh: $1 expects a name" >&2; exit 1; }
         # The names become part of a program for sed.
         [[ $2 =~ ^[[:alnum:]_]+$ ]] || { echo "table1.sh: '$2' is not a ${1#--}" >&2; exit 1; }
         declare "${1#--}=$2"
         shift 2
         ;;
      --accuracy)
         is_accuracy=true
         shift
         ;;
      --figure)
         is_figure=true
         shift
         ;;
      *)
         sed -n '2,/^set/{s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}" >&2
         exit 1
         ;;
   esac
done

scripts/setup.sh build
scripts/build.sh release amontons_app

output=build/table1
rm -rf "$output"
run_rows() { # mesh name, cells, options
   local name=$1 cells=$2 row status=0
   shift 2
   mkdir -p "$output/$name"
   for row in 1 2 3 4 5; do
      sed -E -e "s/cells *= *[0-9]+ *, *[0-9]+/cells = $cells/" \
         -e "s/element *= *'[[:alnum:]]+'/element = '$element'/" \
         -e "s/method *= *'[[:alpha:]_]+'/method = '$method'  variant = '$variant'/" \
         "input/long_bar_$row.nml" >"$output/$name/row_$row.nml"
   done
   build/release/bin/amontons --quiet "$@" --output "$output/$name" "$output/$name"/row_?.nml |
      scripts/helpers/progress.sh /dev/null "$name meshes" || status=$?
   # Status 4, not converged, is told in the table.
   ((status == 0 || status == 4)) || exit "$status"
}
run_rows coarse '32, 10'
run_rows fine '256, 80'
folders=("$output/coarse" "$output/fine")
if $is_accuracy; then
   run_rows refined '32, 10' --set accuracy.refinements=4
   folders+=("$output/refined")
fi
status=0
python3 scripts/helpers/table1.py "${folders[@]}" || status=$?
if $is_figure; then
   build/release/bin/amontons --quiet --output "$output" input/long_bar_map.nml
   scripts/python.sh scripts/helpers/figure.py "$output/coarse" "$output/long_bar_map" "$output"/figure.{png,svg}
fi
exit "$status"
