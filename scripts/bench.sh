#!/usr/bin/env bash
# Times the long bar on 256 x 256 cells, all five rows of Table 1 in one command. Usage: bench.sh [PROGRAM-OPTION...]
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

scripts/setup.sh build
scripts/build.sh release
program=build/release/bin/amontons
bench=build/bench
mkdir -p "$bench"
for row in 1 2 3 4 5; do
   sed -E 's/cells *= *[0-9]+ *, *[0-9]+/cells = 256, 256/' "input/long_bar_$row.nml" >"$bench/long_bar_$row.nml"
done

version_of() { dpkg-query --show --showformat '${Version}' "$1" 2>/dev/null || echo unknown; }
library_of() { ldd "$program" | awk -v name="$1" '$1 ~ name { print $3; exit }' | xargs --no-run-if-empty realpath; }

echo "processor    $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores"
echo "compiler     $(gfortran --version | head -n 1)"
echo "BLAS         $(library_of '^lib(open)?blas')"
echo "SuiteSparse  $(version_of libsuitesparse-dev)"

python3 - "$program" --quiet --output "$bench" "$@" "$bench"/long_bar_?.nml <<'E2'
import resource
import subprocess
import sys
import time

start = time.perf_counter()
status = subprocess.run(sys.argv[1:]).returncode
wall = time.perf_counter() - start
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(f"wall time    {wall:.2f} s")
print(f"user time    {used.ru_utime:.2f} s")
print(f"system time  {used.ru_stime:.2f} s")
print(f"peak memory  {used.ru_maxrss / 1024:.0f} MiB")
sys.exit(status)
E2
