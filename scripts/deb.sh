#!/usr/bin/env bash
# Makes Debian packages for the system it runs on: build/deb/*.deb. Usage: deb.sh
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

scripts/setup.sh build package
folder=build/deb
log=build/deb.log
mkdir -p build
rm -rf "$folder"

make_packages() {
   cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release -DAMONTONS_TESTS=OFF -DCMAKE_INSTALL_PREFIX=/usr \
      "-DCMAKE_INSTALL_LIBDIR=lib/$(dpkg-architecture --query DEB_HOST_MULTIARCH)" \
      -DAMONTONS_PYTHON_DIR=lib/python3/dist-packages -DAMONTONS_PYTHON=/usr/bin/python3 &&
      cmake --build "$folder" --parallel "$(nproc)" --target amontons_app amontons_c amontons &&
      cd "$folder" && cpack -G DEB
}

make_packages 2>&1 | scripts/helpers/progress.sh "$log" packages || { cat "$log" >&2; exit 1; }
ls "$folder"/*.deb
