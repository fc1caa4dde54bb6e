"""The long bar of Table 1, row 1, on n x n plane strain cells in CalculiX. Usage: calculix_bar.py N [FOLDER].

Node-to-surface contact against one rigid cell, set as doc/peers.md says, written as an input file and solved by `ccx`.
Prints the number of closed nodes and the forces of the floor.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

YOUNG, POISSON, FRICTION, SIDE, PUSH, PRESS = 13000.0, 0.2, 1.0, 40.0, 10.0, -5.0
# Stiffness of the penalty and of sticking, in force per volume: the size of the body closes by 1e-4 of its strain.
PENALTY = STICKING = 1e4 * YOUNG / SIDE


def write_input(path, n):
    h = SIDE / n
    node = lambda i, j: j * (n + 1) + i + 1
    below = (n + 1) ** 2
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{node(i, j)}, {i * h!r}, {j * h!r}, 0." for j in range(n + 1) for i in range(n + 1)]
    lines += ["*NODE, NSET=FLOOR"]
    floor = [(-SIDE, -SIDE / 4), (2 * SIDE, -SIDE / 4), (2 * SIDE, 0.0), (-SIDE, 0.0)]
    lines += [f"{below + k + 1}, {x!r}, {y!r}, 0." for k, (x, y) in enumerate(floor)]
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=BODY"]
    lines += [
        f"{j * n + i + 1}, {node(i, j)}, {node(i + 1, j)}, {node(i + 1, j + 1)}, {node(i, j + 1)}"
        for j in range(n)
        for i in range(n)
    ]
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=GROUND", f"{n * n + 1}, " + ", ".join(str(below + k) for k in (1, 2, 3, 4))]
    lines += ["*NSET, NSET=RIGHT"] + [f"{node(n, j)}," for j in range(n + 1)]
    lines += ["*NSET, NSET=BOTTOM"] + [f"{node(i, 0)}," for i in range(n + 1)]
    lines += ["*ELSET, ELSET=LEFTCELLS"] + [f"{j * n + 1}," for j in range(n)]
    lines += ["*ELSET, ELSET=TOPCELLS"] + [f"{(n - 1) * n + i + 1}," for i in range(n)]
    lines += ["*SURFACE, NAME=SLAVE, TYPE=NODE", "BOTTOM,", "*SURFACE, NAME=MASTER", f"{n * n + 1}, S3"]
    for name in ("STEEL", "ROCK"):
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{YOUNG}, {POISSON}"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "1.", "*SOLID SECTION, ELSET=GROUND, MATERIAL=ROCK", "1."]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
    lines += [f"{PENALTY},", "*FRICTION", f"{FRICTION}, {STICKING}"]
    lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=NODE TO SURFACE, ADJUST=1.e-6", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", "FLOOR, 1, 3", "RIGHT, 1, 1", "*STEP, INC=100", "*STATIC", "1., 1."]
    # The side x = 0 is the fourth of its cells, the top the third.
    lines += ["*DLOAD", f"LEFTCELLS, P4, {PUSH}", f"TOPCELLS, P3, {-PRESS}"]
    lines += ["*NODE PRINT, NSET=BOTTOM", "U", "*NODE PRINT, NSET=FLOOR, TOTALS=ONLY", "RF", "*END STEP"]
    path.write_text("\n".join(lines) + "\n")


def main(n):
    with tempfile.TemporaryDirectory() as folder:
        write_input(pathlib.Path(folder, "bar.inp"), n)
        subprocess.run(["ccx", "bar"], cwd=folder, capture_output=True, check=False,
                       env={**os.environ, "OMP_NUM_THREADS": "1"})
        text = pathlib.Path(folder, "bar.dat").read_text()
    rows = [line.split() for line in text.splitlines() if re.match(r"\s+\d+(\s+[-+.\dE]+){3}\s*$", line)]
    closed = sum(float(row[2]) < 1e-9 * SIDE for row in rows)
    # Reactions of the held floor are the forces on the bar, with their sign turned.
    along, across, _ = map(float, text.split()[-3:])
    print(f"closed nodes {closed} of {len(rows)}, normal force {across:.6f}, friction {-along:.6f}")


main(int(sys.argv[1]))
