#!/usr/bin/env python3
"""Solves a deck on meshes that Gmsh makes finer where the estimated error is, until it is as small as asked for.

A mesh of the least number of elements for an error of the norm eta_0 has elements that measure r_e times those of the
mesh at hand, r_e = c eta_e^(-1/(p + 1)), with the order p of the elements and c such that sum r_e^(2 p) eta_e^2 =
eta_0^2. A step asks for no less than a quarter of the error, and changes no size by more than four times.
"""
import argparse
import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from amontons.grid import read_grid

SIDES = {"bottom": 1, "right": 2, "top": 3, "left": 4}
COLUMNS = ("mesh", "nodes", "elements", "error_norm", "relative_error")
MESH_GROUP = re.compile(r"^&mesh\b(?:'[^']*'|![^\n]*|[^/'!])*/", re.MULTILINE | re.IGNORECASE)


class Fault(Exception):
    """What is wrong, in a sentence."""


def main():
    """Adapts meshes; prints a row for each."""
    options = read_options()
    options.output.mkdir(parents=True, exist_ok=True)
    deck = options.deck.read_text(encoding="utf-8")
    geometry, order = find_geometry(options, deck)
    rows = []
    field = None
    for number in range(1, options.steps + 1):
        folder = options.output/f"mesh_{number}"
        make_mesh(geometry, order, field, folder)
        summary, grid = solve(options, deck, folder)
        row = [number, summary["counts"]["nodes"], summary["counts"]["elements"],
               *(summary["accuracy"][key] for key in COLUMNS[3:]),
               *(summary["key_results"][key] for key in options.keys)]
        rows.append(row)
        print_row(options, row, number == 1)
        table = [",".join([*COLUMNS, *options.keys]), *(",".join(map(repr, row)) for row in rows)]
        (options.output/"adapt.csv").write_text("\n".join(table) + "\n", encoding="utf-8")
        draw(grid, folder/"mesh.svg")
        error = max(map(change, zip(*(row[len(COLUMNS):] for row in rows[-3:])))) if options.keys \
            else summary["accuracy"]["relative_error"]
        if error <= options.error:
            break
        # A mesh misses the error that it is made for by some ten percent.
        target = 0.85*options.error if not options.keys else 0.5*summary["accuracy"]["relative_error"]
        field = size_field(grid, order, target*row[3]/row[4], row[3])
    else:
        raise Fault(f"the error is {error:.2%} after {options.steps} meshes; a singular point may need more: --steps")


def change(values):
    """The change of a number from mesh to mesh: the last one, or half of the one before; one alone may be chance."""
    if len(values) < 3:
        return math.inf
    last, before = abs(values[2] - values[1]), abs(values[1] - values[0])
    return max(last, 0.5*before)/max(abs(values[2]), sys.float_info.min)


def read_options():
    """The command line."""
    parser = argparse.ArgumentParser(prog="adapt.sh", description=__doc__.partition("\n")[0])
    parser.add_argument("part", type=Path, metavar="PART", help="geometry for Gmsh (.geo); a mesh of it (.msh) beside "
                        "which it is; or - for the rectangle of the deck")
    parser.add_argument("deck", type=Path, metavar="DECK", help="the deck; its mesh is replaced")
    parser.add_argument("--error", type=percentage, default=0.02, help="relative error of the stresses to reach (2%%)")
    parser.add_argument("--key", dest="keys", action="append", default=[], metavar="NAME",
                        help="reach it instead in the change of this key result from mesh to mesh; may be repeated")
    parser.add_argument("--steps", type=int, default=10, help="most meshes (10)")
    parser.add_argument("--output", type=Path, default=Path("adapt"),
                        help="directory of the meshes and results (adapt)")
    return parser.parse_args()


def percentage(text):
    """A positive number, or a percentage."""
    value = float(text.rstrip("%"))/(100 if text.endswith("%") else 1)
    if not 0 < value < 1:
        raise ValueError(text)
    return value


def find_geometry(options, deck):
    """The geometry file, and the order of its elements."""
    group = MESH_GROUP.search(deck)
    if not group:
        raise Fault(f"{options.deck}: expected a &mesh group")
    element = re.search(r"element\s*=\s*'(\w+)'", group[0])
    if str(options.part) == "-":
        size = re.search(r"size\s*=\s*([^\s,]+)[\s,]+([^\s,/]+)", group[0])
        if not size:
            raise Fault(f"{options.deck}: expected a rectangle, with size, in &mesh; or name its geometry")
        path = options.output/"rectangle.geo"
        path.write_text(rectangle(float(size[1]), float(size[2])), encoding="utf-8")
        return path, 2 if element and element[1] in ("tri6", "quad8", "quad9") else 1
    path = options.part.with_suffix(".geo")
    if not path.exists():
        raise Fault(f"{path}: no such geometry; the meshes are made from it")
    text = path.read_text(encoding="utf-8")
    if re.search(r"^\s*Transfinite", text, re.MULTILINE):
        raise Fault(f"{path}: Transfinite fixes the mesh; it can be adapted without these lines only")
    found = re.search(r"Mesh\.ElementOrder\s*=\s*(\d)", text)
    return path, int(found[1]) if found else 1


def rectangle(width, height):
    """The geometry of a generated rectangle, its sides named as the program names them."""
    lines = [f"Point(1) = {{0, 0, 0, {0.25*min(width, height)!r}}};", f"Point(2) = {{{width!r}, 0, 0}};",
             f"Point(3) = {{{width!r}, {height!r}, 0}};", f"Point(4) = {{0, {height!r}, 0}};",
             *(f"Line({i}) = {{{i}, {i % 4 + 1}}};" for i in range(1, 5)),
             "Curve Loop(1) = {1:4};", "Plane Surface(1) = {1};",
             *(f'Physical Curve("{name}") = {{{line}}};' for name, line in SIDES.items()),
             'Physical Surface("body") = {1};']
    return "\n".join(lines) + "\n"


def make_mesh(geometry, order, field, folder):
    """Meshes the geometry; with the sizes of a field, if there is one, in the place of those of the geometry."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    command = ["gmsh", "-2", "-format", "msh41", "-order", str(order), str(geometry), "-o", str(folder/"part.msh")]
    if field:
        (folder/"size.pos").write_text(field, encoding="utf-8")
        command += ["-bgm", str(folder/"size.pos")]
        for source in ("FromPoints", "ExtendFromBoundary", "FromCurvature"):
            command += ["-setnumber", f"Mesh.MeshSize{source}", "0"]
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if run.returncode != 0 or not (folder/"part.msh").exists():
        errors = [line.partition(":")[2].strip() for line in run.stdout.splitlines() if line.startswith("Error")]
        raise Fault(f"gmsh cannot mesh {geometry}: {(errors + [run.stdout.strip()])[0]}")


def solve(options, deck, folder):
    """Solves the deck on the mesh of a folder; returns its summary and grid."""
    mesh = f"&mesh kind = 'file'  file = '{(folder/'part.msh').resolve()}' /"
    # Files that the deck names are beside it.
    run = subprocess.run([os.environ["AMONTONS"], "--quiet", "--set", f"case.name={options.deck.stem}", "--output",
                          str(folder.resolve()), "-"], cwd=options.deck.resolve().parent, text=True, check=False,
                         input=MESH_GROUP.sub(lambda _: mesh, deck, count=1), capture_output=True)
    if run.returncode != 0:
        raise Fault((run.stdout + run.stderr).strip())
    stem = str(folder/options.deck.stem)
    summary = json.loads(Path(stem + ".summary.json").read_text(encoding="utf-8"))
    unknown = [key for key in options.keys if key not in summary["key_results"]]
    if unknown:
        raise Fault(f"'{unknown[0]}' is not a key result (they are {', '.join(summary['key_results'])})")
    return summary, read_grid(stem + ".vtu")


def size_field(grid, order, target, norm):
    """The sizes that a mesh must have for the norm of its error to reach a target, as a view of Gmsh."""
    error = np.maximum(grid.cell_data["error_norm"], 1e-6*norm/math.sqrt(len(grid.cell_data["error_norm"])))
    goal = max(target, 0.25*norm)
    factor = (goal**2/np.sum(error**(2/(order + 1))))**(0.5/order)
    ratio = np.clip(factor*error**(-1/(order + 1)), 0.25, 4.0)
    corners = [(nodes[:, :3 if "triangle" in kind else 4]) for kind, nodes in grid.cells]
    logarithm, number = np.zeros(len(grid.points)), np.zeros(len(grid.points))
    first = 0
    for nodes in corners:
        x = grid.points[nodes]
        sides = np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2)
        wanted = np.log(sides.mean(axis=1)*ratio[first:first + len(nodes)])
        first += len(nodes)
        np.add.at(logarithm, nodes, wanted[:, None])
        np.add.at(number, nodes, 1.0)
    size = np.exp(logarithm/np.maximum(number, 1.0))
    lines = ['View "size" {']
    for nodes in corners:
        name = "ST" if nodes.shape[1] == 3 else "SQ"
        for cell in nodes:
            places = ",".join(f"{x!r},{y!r},0" for x, y in grid.points[cell][:, :2].tolist())
            lines.append(f"{name}({places}){{{','.join(map(repr, size[cell].tolist()))}}};")
    return "\n".join([*lines, "};"]) + "\n"


def print_row(options, row, is_first):
    """Prints a row of the history, behind its headings."""
    headings = [*COLUMNS, *options.keys]
    if is_first:
        print("  ".join(f"{heading:>14}" for heading in headings))
    print("  ".join(f"{value:>14.6g}" for value in row), flush=True)


def draw(grid, path):
    """Draws a mesh as an SVG picture."""
    low, high = grid.points.min(axis=0), grid.points.max(axis=0)
    scale = 1000.0/max(high[0] - low[0], high[1] - low[1])
    shapes = []
    for kind, nodes in grid.cells:
        for x in grid.points[nodes[:, :3 if "triangle" in kind else 4]]:
            shapes.append("M" + "L".join(f"{scale*(a - low[0]):.1f} {scale*(high[1] - b):.1f}" for a, b, _ in x) + "Z")
    width, height = (scale*(high - low))[:2]
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2 -2 {width + 4:.0f} {height + 4:.0f}"><path '
                    f'd="{"".join(shapes)}" fill="none" stroke="#345" stroke-width="0.5"/></svg>\n', encoding="utf-8")


if __name__ == "__main__":
    try:
        main()
    except Fault as fault:
        sys.exit(f"adapt.sh: {fault}")
