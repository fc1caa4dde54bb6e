#!/usr/bin/env bash
# Installs what is missing, builds the debug preset and runs every test. Usage: test.sh [CTEST-OPTION...]
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

scripts/setup.sh build test
scripts/build.sh debug

results=build/debug/results.xml
rm -f "$results"
status=0
# Counting reads the tests' output, so none of it may be cut.
ctest --preset debug --parallel 2 --no-tests=error --output-junit results.xml \
   --test-output-size-passed 100000000 --test-output-size-failed 100000000 --verbose "$@" |
   python3 -B scripts/dev/count_tests.py --follow || status=$?
python3 scripts/dev/count_tests.py "$results" || status=1
exit "$status"
