#!/usr/bin/env bash
# Runs the tests of the coverage preset and prints which lines of src/ no test reached; fails below 92 % of the lines.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

scripts/setup.sh build test check
scripts/tools.sh
scripts/build.sh coverage
find build/coverage -name '*.gcda' -delete
ctest --preset coverage --parallel 2 --no-tests=error
.venv/bin/python -m gcovr --root . --filter src/ --object-directory build/coverage --fail-under-line 92
