"""Ironing in CalculiX beside the program: an elastic tool is pressed into an elastic floor and drawn along it.

Usage: calculix_ironing.py PROGRAM [INCREMENTS]

The bodies are those of tests/verification/decks/ironing.nml, both written as one mesh file; in CalculiX they are one
layer of hexahedra that is held across. Prints the processor time of both, the force of the pressed tool, friction over normal
force while it slides, and by how much the normal force ripples.
"""

import csv
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

YOUNG, FRICTION, DEPTH, WAY = 1000.0, 0.3, 0.006, 1.0
# Stiffness of the penalty over Young's modulus, and slope of sticking over that.
PENALTY, STICKING = 1e4, 1e2
STEPS = 300


def grown(count, ratio):
    """Places from 0 to 1, each step larger by a ratio."""
    total = sum(ratio ** k for k in range(count))
    return [sum(ratio ** k for k in range(n)) / total for n in range(count + 1)]


def bodies():
    """The nodes of tool and floor, row by row from below, and the numbers of cells across and up."""
    across = [-0.4 + 0.8 * i / 20 for i in range(21)]
    tool = [(x, 0.5 * t + (3.0 - (9.0 - x * x) ** 0.5) * (1.0 - t)) for t in grown(8, 1.25) for x in across]
    heights = [-t for t in reversed(grown(9, 1.25))]
    floor = [(-1.0 + 3.0 * i / 90, y) for y in heights for i in range(91)]
    return {"tool": (tool, 20, 8), "floor": (floor, 90, 9)}


def cells_of(across, up, first):
    """The nodes of the cells of a body, counterclockwise."""
    row = across + 1
    return [(first + j * row + i, first + j * row + i + 1, first + (j + 1) * row + i + 1, first + (j + 1) * row + i)
            for j in range(up) for i in range(across)]


def mesh_file():
    """Both bodies in Gmsh's format 2.2: regions tool and floor, sets tool.top, tool.bottom, floor.top, floor.bottom."""
    nodes, rows, names, first = [], [], [], 1
    for region, (name, (places, across, up)) in enumerate(bodies().items(), start=1):
        names.append(f'2 {region} "{name}"')
        nodes += [f"{first + k} {x!r} {y!r} 0" for k, (x, y) in enumerate(places)]
        rows += [(3, region, *cell) for cell in cells_of(across, up, first)]
        for side, (group, at) in enumerate((("bottom", 0), ("top", up))):
            number = 10 * region + side
            names.append(f'1 {number} "{name}_{group}"')
            start = first + at * (across + 1)
            rows += [(1, number, start + i, start + i + 1) for i in range(across)]
        first += len(places)
    elements = [" ".join(map(str, (k, kind, 2, group, group, *members)))
                for k, (kind, group, *members) in enumerate(rows, 1)]
    return "\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names)), *names,
                      "$EndPhysicalNames", "$Nodes", str(len(nodes)), *nodes, "$EndNodes",
                      "$Elements", str(len(elements)), *elements, "$EndElements", ""])


def deck():
    """The deck of the program."""
    return f"""&mesh file = 'ironing.msh' /
&material young = {YOUNG}  poisson = 0.3  hypothesis = 'plane strain' /
&support name = 'press'  set = 'tool_top'  uy = {-DEPTH} /
&support name = 'slide'  set = 'tool_top'  ux = {WAY} /
&support set = 'floor_bottom'  ux = 0.0  uy = 0.0 /
&contact set = 'tool_bottom'  against = 'floor_top'  friction = {FRICTION}  search = 0.2  sliding = 'finite' /
&history times = 0.0, 1.0, 2.0  substeps = 1, {STEPS} /
&steps support = 'press'  factor = 0.0, 1.0, 1.0 /
&steps support = 'slide'  factor = 0.0, 0.0, 1.0 /
"""


def input_file(increments):
    """The input file of CalculiX."""
    lines, first, thickness, number = [], 1, 0.1, {}
    for name, (places, across, up) in bodies().items():
        count = len(places)
        lines += ["*NODE"] + [f"{first + k + layer * count}, {x!r}, {y!r}, {layer * thickness}"
                              for layer in (0, 1) for k, (x, y) in enumerate(places)]
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        for k, cell in enumerate(cells_of(across, up, first)):
            number[name, k] = len(number) + 1
            lines.append(", ".join(map(str, (number[name, k], *cell, *(n + count for n in cell)))))
        for side, at in (("bottom", 0), ("top", up)):
            start = first + at * (across + 1)
            lines += [f"*NSET, NSET={name}_{side}"] + [f"{start + i + layer * count}," for layer in (0, 1)
                                                        for i in range(across + 1)]
        lines += [f"*NSET, NSET={name}_all"] + [f"{first + k}," for k in range(2 * count)]
        lines += [f"*MATERIAL, NAME=OF_{name}", "*ELASTIC", f"{YOUNG}, 0.3",
                  f"*SOLID SECTION, ELSET={name}, MATERIAL=OF_{name}"]
        first += 2 * count
    # The lower face of a cell lies along its nodes 1 and 2, the upper one along 3 and 4.
    lines += ["*SURFACE, NAME=SLAVE"] + [f"{number['tool', i]}, S3" for i in range(20)]
    lines += ["*SURFACE, NAME=MASTER"] + [f"{number['floor', 8 * 90 + i]}, S5" for i in range(90)]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH",
              "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY * YOUNG}",
              "*FRICTION", f"{FRICTION}, {STICKING * YOUNG}",
              "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER",
              "*BOUNDARY", "tool_all, 3, 3", "floor_all, 3, 3", "floor_bottom, 1, 2"]
    share = 1.0 / increments
    for sizes, way in (("1., 1.", 0.0), (f"{share!r}, 1., 1e-6, {share!r}", WAY)):
        lines += [f"*STEP, INC={20 * increments}", "*STATIC", sizes, "*BOUNDARY",
                  f"tool_top, 1, 1, {way!r}", f"tool_top, 2, 2, {-DEPTH!r}",
                  "*NODE PRINT, NSET=tool_top, TOTALS=ONLY", "RF", "*END STEP"]
    return "\n".join(lines) + "\n", thickness


def processor_time(command, folder):
    """Runs a command; the processor time of it on one thread."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False,
                         env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if run.returncode:
        sys.exit(run.stdout[-2000:] + run.stderr[-2000:])
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def row(name, seconds, forces):
    """A row of the table, from forces along and across the floor, the first one pressed alone."""
    sliding = [abs(normal) for _, normal in forces[len(forces) // 3:]]
    mean = sum(sliding) / len(sliding)
    along = sum(abs(tangential) for tangential, _ in forces[len(forces) // 3:]) / len(sliding)
    return (f"| {name} | {len(forces) - 1} | {seconds:.3g} | {abs(forces[0][1]):.4f} | {along / mean:.4f} | "
            f"{100 * (max(sliding) - min(sliding)) / mean:.2f} % |")


def main(program, increments="80"):
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        (place / "ironing.msh").write_text(mesh_file())
        (place / "ironing.nml").write_text(deck())
        seconds = processor_time([str(pathlib.Path(program).resolve()), "--quiet", "ironing.nml"], folder)
        with open(place / "ironing.history.csv", newline="") as table:
            rows = list(csv.DictReader(table))
        ours = [(float(r["reaction_x_slide"]), float(r["reaction_y_press"])) for r in rows[1:]]
        text, thickness = input_file(int(increments))
        (place / "iron.inp").write_text(text)
        print("| | steps | processor time s | pressed N | T/N | ripple of N |\n| --- | --- | --- | --- | --- | --- |")
        print(row("Amontons", seconds, ours))
        seconds = processor_time(["ccx", "iron"], folder)
        totals = re.findall(r"set TOOL_TOP and time\s+\S+\s+([-+.\dE]+)\s+([-+.\dE]+)",
                            (place / "iron.dat").read_text())
        print(row("CalculiX", seconds, [(float(x) / thickness, float(y) / thickness) for x, y in totals]))


main(*sys.argv[1:])
