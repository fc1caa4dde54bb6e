#!/usr/bin/env bash
# What every finding begins with, sourced: a temporary folder to work in, Debian packages of given versions, and the
# comparison of what was printed.
set -euo pipefail

work=$(mktemp --directory)
trap 'rm -rf "$work"' EXIT
cd "$work"
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 LC_ALL=C

is_installed() { # NAME=VERSION
   [[ $(dpkg-query --show --showformat '${Version}' "${1%%=*}" 2>/dev/null) == "${1#*=}" ]]
}

# Asks for a compiler, which cannot be unpacked alone.
need() { # NAME=VERSION
   is_installed "$1" || { echo "$1 is not installed"; exit 77; }
}

# Takes Debian packages NAME=VERSION as they are installed, or else unpacks them here.
take() {
   local package
   for package in "$@"; do
      ! is_installed "$package" || continue
      apt-get download --quiet=2 "$package" &>download.log || { echo "$package cannot be had"; exit 77; }
      dpkg-deb --extract "${package%%=*}"_*.deb root
      rm -f ./*.deb
   done
   PATH=$work/root/usr/bin:$PATH
   LD_LIBRARY_PATH=$work/root/usr/lib/x86_64-linux-gnu${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
   PYTHONPATH=$work/root/usr/lib/python3/dist-packages${PYTHONPATH:+:$PYTHONPATH}
   export PATH LD_LIBRARY_PATH PYTHONPATH
}

# Compares standard input with what was seen.
seen() { # lines
   diff --ignore-all-space --label seen --label now <(printf '%s\n' "$@") -
}
