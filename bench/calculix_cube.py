"""A cube of n x n x n hexahedra on a rough floor, its top moved, in CalculiX. Usage: calculix_cube.py N.

Mortar contact against one rigid cell, with the penalties of doc/peers.md, written as an input file and solved by `ccx`.
Prints normal and tangential force of the floor.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

YOUNG, POISSON, FRICTION, MOTION = 1.0, 0.3, 0.3, (0.02, 0.005, -0.05)
# Stiffness of the penalty and of sticking, in force per volume.
PENALTY, STICKING = 1e5 * YOUNG, 1e4 * YOUNG


def write_input(path, n):
    node = lambda i, j, k: (k * (n + 1) + j) * (n + 1) + i + 1
    below = (n + 1) ** 3
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    grid = range(n + 1)
    lines = ["*NODE"]
    lines += [f"{node(i, j, k)}, {i / n!r}, {j / n!r}, {k / n!r}" for k in grid for j in grid for i in grid]
    lines += [f"{below + k + 1}, {3 * x - 1}., {3 * y - 1}., {z - 1}." for k, (x, y, z) in enumerate(corners)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=BODY"]
    lines += [f"{(k * n + j) * n + i + 1}, " + ", ".join(str(node(i + x, j + y, k + z)) for x, y, z in corners)
              for k in range(n) for j in range(n) for i in range(n)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=GROUND", f"{n**3 + 1}, " + ", ".join(str(below + k) for k in range(1, 9))]
    lines += ["*NSET, NSET=TOP"] + [f"{node(i, j, n)}," for j in grid for i in grid]
    lines += ["*NSET, NSET=FLOOR"] + [f"{below + k}," for k in range(1, 9)]
    lines += ["*SURFACE, NAME=SLAVE"] + [f"{j * n + i + 1}, S1" for j in range(n) for i in range(n)]
    lines += ["*SURFACE, NAME=MASTER", f"{n**3 + 1}, S2"]
    for name in ("STEEL", "ROCK"):
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{YOUNG}, {POISSON}"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "*SOLID SECTION, ELSET=GROUND, MATERIAL=ROCK"]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY},"]
    lines += ["*FRICTION", f"{FRICTION}, {STICKING}"]
    lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=MORTAR", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", "FLOOR, 1, 3", "*STEP, INC=100", "*STATIC", "1., 1.", "*BOUNDARY"]
    lines += [f"TOP, {axis}, {axis}, {motion!r}" for axis, motion in enumerate(MOTION, start=1)]
    lines += ["*NODE PRINT, NSET=TOP, TOTALS=ONLY", "RF", "*END STEP"]
    path.write_text("\n".join(lines) + "\n")


def main(n):
    with tempfile.TemporaryDirectory() as folder:
        write_input(pathlib.Path(folder, "cube.inp"), n)
        subprocess.run(["ccx", "cube"], cwd=folder, capture_output=True, check=False,
                       env={**os.environ, "OMP_NUM_THREADS": "1"})
        text = pathlib.Path(folder, "cube.dat").read_text()
    along, _, across = map(float, re.findall(r"[-+.\dE]+", text.splitlines()[-1]))
    print(f"normal {-across:.7e} friction {along:.7e}")


main(int(sys.argv[1]))
