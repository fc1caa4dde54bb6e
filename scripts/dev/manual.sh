#!/usr/bin/env bash
# Builds the manual, build/manual/index.html: the pages of doc/ and the reference of the library, to be read offline.
# Usage: manual.sh [--update]
#   --update    only put into the tables of the pages what program, manual page and sources say
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."

scripts/setup.sh build manual
scripts/build.sh release amontons_app
program=build/release/bin/amontons
if [[ ${1-} == --update ]]; then
   exec python3 -B scripts/dev/page_tables.py "$program" --update
fi
scripts/dev/tools.sh
python3 -B scripts/dev/page_tables.py "$program"
python3 -B scripts/dev/check_links.py
rm -rf build/manual
mkdir -p build/manual
log=build/manual.log
python3 -B scripts/dev/ford_page.py >build/ford.md
.venv/bin/python -m ford --output_dir "$PWD/build/manual/api" --no-search build/ford.md &>"$log" ||
   { cat "$log" >&2; exit 1; }
if grep --after-context 2 '^Warning' "$log" >&2; then exit 1; fi
python3 -B scripts/dev/manual.py build/manual
echo "$PWD/build/manual/index.html"
