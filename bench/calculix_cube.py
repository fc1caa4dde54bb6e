"""A cube of n x n x n hexahedra on a rough floor, its top moved, in CalculiX. Usage: calculix_cube.py N [M]
   M    on a cube of m x m x m hexahedra instead, whose bottom is held

Mortar contact, against one rigid cell if there is a floor, with the penalties of doc/peers.md, written as an input file and
solved by `ccx`. Prints normal and tangential force of the top.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

YOUNG, POISSON, FRICTION = 1.0, 0.3, 0.3
# Of the top, on a floor and on another cube.
MOTION, MOTION_ON_CUBE = (0.02, 0.005, -0.05), (0.03, 0.0075, -0.02)
# Stiffness of the penalty and of sticking, in force per volume.
PENALTY, STICKING = 1e5 * YOUNG, 1e4 * YOUNG


CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def box(name, n, first, size, origin):
    """The lines of the nodes of n x n x n cells, numbered from a first one on, and of its elements, numbered likewise;
    the numbers of the nodes of its bottom and top, and of the elements there."""
    node = lambda i, j, k: first + (k * (n + 1) + j) * (n + 1) + i
    grid, cells = range(n + 1), range(n)
    lines = ["*NODE"] + [f"{node(*at)}, " + ", ".join(repr(o + s * a / n) for o, s, a in zip(origin, size, at))
                         for at in ((i, j, k) for k in grid for j in grid for i in grid)]
    lines += [f"*ELEMENT, TYPE=C3D8, ELSET={name}"]
    lines += [f"{first + (k * n + j) * n + i}, " + ", ".join(str(node(i + x, j + y, k + z)) for x, y, z in CORNERS)
              for k in cells for j in cells for i in cells]
    return lines, [[node(i, j, k) for j in grid for i in grid] for k in (0, n)], [
        [first + (k * n + j) * n + i for j in cells for i in cells] for k in (0, n - 1)]


def write_input(path, n, below):
    lines, (_, top), (slave, _) = box("BODY", n, 1, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
    ground = box("GROUND", below or 1, (n + 1) ** 3 + 1, (1.0, 1.0, 1.0) if below else (3.0, 3.0, 1.0),
                 (0.0, 0.0, -1.0) if below else (-1.0, -1.0, -1.0))
    lines += ground[0]
    lines += ["*NSET, NSET=TOP"] + [f"{i}," for i in top]
    lines += ["*NSET, NSET=FLOOR"] + [f"{i}," for i in ground[1][0] + ([] if below else ground[1][1])]
    lines += ["*SURFACE, NAME=SLAVE"] + [f"{i}, S1" for i in slave]
    lines += ["*SURFACE, NAME=MASTER"] + [f"{i}, S2" for i in ground[2][1]]
    for name in ("STEEL", "ROCK"):
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{YOUNG}, {POISSON}"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "*SOLID SECTION, ELSET=GROUND, MATERIAL=ROCK"]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY},"]
    lines += ["*FRICTION", f"{FRICTION}, {STICKING}"]
    lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=MORTAR", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", "FLOOR, 1, 3", "*STEP, INC=100", "*STATIC", "1., 1.", "*BOUNDARY"]
    lines += [f"TOP, {axis}, {axis}, {motion!r}" for axis, motion in enumerate(MOTION_ON_CUBE if below else MOTION, start=1)]
    lines += ["*NODE PRINT, NSET=TOP, TOTALS=ONLY", "RF", "*END STEP"]
    path.write_text("\n".join(lines) + "\n")


def main(n, below=0):
    with tempfile.TemporaryDirectory() as folder:
        write_input(pathlib.Path(folder, "cube.inp"), n, below)
        subprocess.run(["ccx", "cube"], cwd=folder, capture_output=True, check=False,
                       env={**os.environ, "OMP_NUM_THREADS": "1"})
        text = pathlib.Path(folder, "cube.dat").read_text()
    along, _, across = map(float, re.findall(r"[-+.\dE]+", text.splitlines()[-1]))
    print(f"normal {-across:.7e} friction {along:.7e}")


main(*map(int, sys.argv[1:]))
