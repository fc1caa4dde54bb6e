#!/usr/bin/env bash
# Builds and installs the release twice, from copies of the sources in two folders, and compares every installed file.
# Exit status: 0 if all are the same to the last bit.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."

scripts/setup.sh build
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build() { # folder
   cmake -S "$1/sources" -B "$1/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DAMONTONS_TESTS=OFF \
      -DCMAKE_INSTALL_PREFIX=/usr &&
      cmake --build "$1/build" --parallel "$(nproc)" &&
      DESTDIR=$1/installed cmake --install "$1/build"
}

folders=("$work/one" "$work/a/deeper/folder")
for folder in "${folders[@]}"; do
   mkdir -p "$folder/sources"
   cp -R CMakeLists.txt bench cmake doc python src "$folder/sources"
done
sums=()
for folder in "${folders[@]}"; do
   build "$folder" &>"$work/log" || { cat "$work/log" >&2; exit 1; }
   (cd "$folder/installed" && find . -type f -print0 | sort -z | xargs -0 sha256sum) >"$folder/sums"
   sums+=("$folder/sums")
done
diff "${sums[@]}" || { echo 'reproducible.sh: these files differ' >&2; exit 1; }
echo "$(wc -l <"${sums[0]}") installed files are the same from both folders"
