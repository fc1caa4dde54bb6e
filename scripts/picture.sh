#!/usr/bin/env bash
# Draws the deformed bar of Table 1, row 1, from the program's own files: doc/images/long_bar.png.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

scripts/setup.sh build pictures
scripts/build.sh release
output=build/picture
build/release/bin/amontons --quiet --output "$output" input/long_bar_1.nml
mkdir -p doc/images
/usr/bin/python3 scripts/picture.py "$output" long_bar_1 doc/images/long_bar.png
