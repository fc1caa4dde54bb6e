#!/usr/bin/env bash
# CalculiX 2.20: a square of 32 x 32 cells, pressed on a rigid floor and pushed along it, friction 1, NODE TO SURFACE
# with a stiff linear penalty. Displacements are small and the normal is constant. Expected: the same forces in one
# increment as in ten. Seen: 0.16 % more friction in one, as one node too many stays closed; both end with "Job
# finished".
# shellcheck source=SCRIPTDIR/helpers/finding.sh
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/helpers/finding.sh"
take calculix-ccx=2.20-1 libspooles2.2=2.2-14 libarpack2=3.8.0-3

cat >square.py <<'SOURCE'
import sys
N, SIDE, YOUNG = 32, 40.0, 13000.0
def node(i, j): return j*(N + 1) + i + 1
line = ["*NODE"] + [f"{node(i, j)}, {i*SIDE/N}, {j*SIDE/N}, 0." for j in range(N + 1) for i in range(N + 1)]
below = (N + 1)**2
line += ["*NODE, NSET=FLOOR"] + [f"{below + k}, {x}, {y}, 0." for k, (x, y) in enumerate(
    [(-40, -10), (80, -10), (80, 0), (-40, 0)], 1)]
line += ["*ELEMENT, TYPE=CPE4, ELSET=BODY"] + [
    f"{j*N + i + 1}, {node(i, j)}, {node(i + 1, j)}, {node(i + 1, j + 1)}, {node(i, j + 1)}"
    for j in range(N) for i in range(N)]
line += ["*ELEMENT, TYPE=CPE4, ELSET=GROUND", f"{N*N + 1}, {below + 1}, {below + 2}, {below + 3}, {below + 4}"]
line += ["*NSET, NSET=RIGHT"] + [f"{node(N, j)}," for j in range(N + 1)]
line += ["*NSET, NSET=BOTTOM"] + [f"{node(i, 0)}," for i in range(N + 1)]
line += ["*ELSET, ELSET=LEFT"] + [f"{j*N + 1}," for j in range(N)]
line += ["*ELSET, ELSET=TOP"] + [f"{(N - 1)*N + i + 1}," for i in range(N)]
line += ["*SURFACE, NAME=SLAVE, TYPE=NODE", "BOTTOM,", "*SURFACE, NAME=MASTER", f"{N*N + 1}, S3",
         "*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG}, 0.2", "*SOLID SECTION, ELSET=BODY, MATERIAL=M", "1.",
         "*SOLID SECTION, ELSET=GROUND, MATERIAL=M", "1.", "*SURFACE INTERACTION, NAME=I",
         "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{1e5*YOUNG/SIDE}", "*FRICTION", f"1., {1e5*YOUNG/SIDE}",
         "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE, ADJUST=1.e-6", "SLAVE, MASTER",
         "*BOUNDARY", "FLOOR, 1, 3", "RIGHT, 1, 1", "*STEP, INC=100", "*STATIC", f"{sys.argv[1]}, 1.",
         "*DLOAD", "LEFT, P4, 10.", "TOP, P3, 5.", "*NODE PRINT, NSET=FLOOR, TOTALS=ONLY", "RF", "*END STEP"]
print("\n".join(line))
SOURCE
for increment in 1. .1; do
   python3 square.py "$increment" >square.inp
   ccx square | grep --only-matching 'Job finished' || true
   grep -v '^ *$' square.dat | tail -n 1 | awk '{printf "%.2f %.2f\n", -$1, $2}'
done | seen 'Job finished' '108.06 200.00' 'Job finished' '107.88 200.00'
