#!/usr/bin/env bash
# Runs the tests of the coverage preset; prints which lines and which error messages of src/ no test reached, and the
# share of lines of each room. Fails below 92 % of the lines, and where a message is neither raised nor waived.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."

scripts/setup.sh build test
scripts/build.sh coverage
find build/coverage -name '*.gcda' -delete
# The counters of runs on a full disk cannot be written, either: that is not for standard error, which tests read.
GCOV_ERROR_FILE=/dev/null ctest --preset coverage --parallel 2 --no-tests=error
python3 -B scripts/dev/coverage.py build/coverage
