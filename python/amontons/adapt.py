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
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from amontons.grid import read_grid

SIDES = {"bottom": 1, "right": 2, "top": 3, "left": 4}
COLUMNS = ("mesh", "nodes", "elements", "error_norm", "relative_error")
MOST_DRAWN = 20000  # elements of a mesh in the picture of all
# What the geometry says about sizes counts on the first mesh only.
SIZES = """Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeFactor = 1;
Mesh.MeshSizeMin = 0;
Mesh.MeshSizeMax = 1e22;
number = newf;
Field[number] = PostView;
Field[number].ViewIndex = PostProcessing.NbViews - 1;
Background Field = number;
"""


# Keys of &mesh that the new meshes have too.
NAME = r"\bname\s*=\s*'[^']*'"
ORIGIN = r"\borigin\s*=\s*([^\s,]+)[\s,]+([^\s,/]+)"


def group(name):
    """The pattern of a group of a deck."""
    return re.compile(r"^&" + name + r"\b(?:'[^']*'|![^\n]*|[^/'!])*/", re.MULTILINE | re.IGNORECASE)


class Fault(Exception):
    """What is wrong, in a sentence."""


def main(arguments):
    """Adapts meshes as the arguments say. Returns the exit status."""
    try:
        adapt(read_options(arguments))
    except Fault as fault:
        sys.exit(f"adapt: {fault}")
    return 0


def adapt(options):
    """Adapts meshes; prints a row for each."""
    deck = read_deck(options.deck)
    options.output.mkdir(parents=True, exist_ok=True)
    geometry, order = find_geometry(options, deck)
    rows, pictures = [], []
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
        picture = draw(grid)
        (folder/"mesh.svg").write_text(collect([picture], 1000), encoding="utf-8")
        if row[2] <= MOST_DRAWN:
            pictures.append(Picture(f"{number}: {row[2]} elements, {row[4]:.2%}", *picture[1:]))
        (options.output/"meshes.svg").write_text(collect(pictures, 240), encoding="utf-8")
        errors, *values = zip(*(row[len(COLUMNS) - 1:] for row in rows))
        error = max(remaining(numbers, errors) for numbers in values) if options.keys else errors[-1]
        if error <= options.error:
            break
        refuse_growth(options, rows)
        # A mesh misses the error that it is made for by some ten percent.
        target = 0.85*options.error if not options.keys else 0.5*summary["accuracy"]["relative_error"]
        field = size_field(grid, order, target*row[3]/row[4], row[3])
    else:
        raise Fault(f"the error is {error:.2%} after {options.steps} meshes; a singular point may need more: --steps")


def remaining(values, errors):
    """The error that is left of a number, over its size, by its last two changes from mesh to mesh.

    It is taken to fall with the estimated error of the stresses: a change of v while that falls to the part r leaves
    v r/(1 - r). Both changes must say so, since one alone may be small by chance.
    """
    left = 0.0
    for k in (1, 2):
        if len(values) < 3 or errors[-k] >= errors[-k - 1]:
            return math.inf
        left = max(left, abs(values[-k] - values[-k - 1])*errors[-1]/(errors[-k - 1] - errors[-k]))
    return left/max(abs(values[-1]), sys.float_info.min)


def refuse_growth(options, rows):
    """Refuses a key result that changes more from each mesh to the next, four times in a row, by a tenth at last."""
    for key, values in zip(options.keys, zip(*(row[len(COLUMNS):] for row in rows[-5:]))):
        changes = [abs(b - a) for a, b in zip(values, values[1:])]
        if len(changes) == 4 and changes == sorted(changes) and changes[-1] > 0.1*abs(values[-1]):
            raise Fault(f"{key} has no limit: it changes more from each mesh to the next ({values[-1]:.6g} after "
                        f"{values[-2]:.6g}), as at a re-entrant corner or at the end of a flat contact")


def read_options(arguments):
    """The command line."""
    parser = argparse.ArgumentParser(prog="amontons-adapt", description=__doc__.partition("\n")[0])
    parser.add_argument("part", type=Path, metavar="PART", help="geometry for Gmsh (.geo); a mesh of it (.msh) beside "
                        "which it is; or - for the rectangle of the deck")
    parser.add_argument("deck", type=Path, metavar="DECK", help="the deck; its mesh is replaced")
    parser.add_argument("--error", type=percentage, default=0.02, help="relative error of the stresses to reach (2%%)")
    parser.add_argument("--key", dest="keys", action="append", default=[], metavar="NAME",
                        help="reach it instead in this key result, by its changes from mesh to mesh; may be repeated")
    parser.add_argument("--steps", type=count, default=10, help="most meshes (10)")
    parser.add_argument("--output", type=Path, default=Path("adapt"),
                        help="directory of the meshes and results (adapt)")
    return parser.parse_args(arguments)


def percentage(text):
    """A positive number, or a percentage."""
    try:
        value = float(text.rstrip("%"))/(100 if text.endswith("%") else 1)
    except ValueError:
        value = 0.0
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"expected a percentage below 100%, as 2%, or a share below 1, found '{text}'")
    return value


def count(text):
    """A whole number, at least 1."""
    if not (text.isdecimal() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"expected a whole number, at least 1, found '{text}'")
    return int(text)


def read_deck(path):
    """The text of the deck, without its &accuracy: every mesh is solved once, and its error estimated."""
    try:
        deck = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Fault(f"{path}: cannot be read: {getattr(error, 'strerror', None) or 'not UTF-8'}") from error
    if group("sweep").search(deck):
        raise Fault(f"{path}: the cases of a &sweep need a mesh each; adapt one of them alone")
    return group("accuracy").sub("", deck)


def find_geometry(options, deck):
    """The geometry file, and the order of its elements."""
    if options.part.suffix == ".nml":
        raise Fault(f"{options.part}: expected a geometry, PART.geo or -, before the deck")
    meshes = group("mesh").findall(deck)
    if len(meshes) != 1:
        raise Fault(f"{options.deck}: expected one &mesh group, found {len(meshes)}; put all bodies into one geometry")
    mesh = meshes[0]
    element = re.search(r"element\s*=\s*'(\w+)'", mesh)
    if str(options.part) == "-":
        size = re.search(r"size\s*=\s*([^\s,]+)[\s,]+([^\s,/]+)", mesh)
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
    source = geometry
    if field:
        (folder/"size.pos").write_text(field, encoding="utf-8")
        source = folder/"part.geo"
        source.write_text(f'Include "{geometry.resolve()}";\nMerge "size.pos";\n{SIZES}', encoding="utf-8")
    command = ["gmsh", "-2", "-format", "msh41", "-order", str(order), str(source), "-o", str(folder/"part.msh")]
    try:
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    except FileNotFoundError as error:
        raise Fault("gmsh is not installed; it makes the meshes (Debian's package gmsh)") from error
    if run.returncode != 0 or not (folder/"part.msh").exists():
        errors = [line.partition(":")[2].strip() for line in run.stdout.splitlines() if line.startswith("Error")]
        raise Fault(f"gmsh cannot mesh {geometry}: {(errors + [run.stdout.strip()])[0]}")
    if "$PhysicalNames" not in (folder/"part.msh").read_text(encoding="utf-8"):
        raise Fault(f"{geometry}: no physical groups; name boundaries by Physical Curve, the body by Physical Surface")


def program():
    """The program: that of the environment variable AMONTONS, of a wheel, or of the search path."""
    inside = Path(__file__).parent/"bin"/"amontons"
    found = os.environ.get("AMONTONS") or (str(inside) if inside.is_file() else shutil.which("amontons"))
    if not found:
        raise Fault("the program amontons is not in the search path; name it in the environment variable AMONTONS")
    return found


def solve(options, deck, folder):
    """Solves the deck on the mesh of a folder; returns its summary and grid."""
    old = group("mesh").search(deck)[0]
    kept = [found[0] for found in map(lambda key: re.search(key, old, re.IGNORECASE), (NAME, ORIGIN)) if found]
    mesh = f"&mesh kind = 'file'  file = '{(folder/'part.msh').resolve()}'  {'  '.join(kept)} /"
    # Files that the deck names are beside it.
    run = subprocess.run([program(), "--quiet", "--set", f"case.name={options.deck.stem}", "--output",
                          str(folder.resolve()), "-"], cwd=options.deck.resolve().parent, text=True, check=False,
                         input=deck.replace(old, mesh, 1), capture_output=True)
    if run.returncode != 0:
        raise Fault((run.stdout + run.stderr).strip())
    stem = str(folder/options.deck.stem)
    summary = json.loads(Path(stem + ".summary.json").read_text(encoding="utf-8"))
    unknown = [key for key in options.keys if key not in summary["key_results"]]
    if unknown:
        raise Fault(f"'{unknown[0]}' is not a key result (they are {', '.join(summary['key_results'])})")
    grid = read_grid(stem + ".vtu")
    origin = re.search(ORIGIN, old, re.IGNORECASE)
    if origin:
        # Sizes belong to the geometry, wherever the deck puts it.
        shift = [float(value.lower().replace("d", "e")) for value in origin.groups()]
        grid = replace(grid, points=grid.points - np.array([*shift, 0.0]))
    return summary, grid


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


class Picture(NamedTuple):
    """A drawn mesh."""
    label: str
    path: str  # its elements, as an SVG path, the longer side of the mesh being 1000
    size: tuple  # width and height


def draw(grid):
    """Draws a mesh."""
    low, high = grid.points.min(axis=0), grid.points.max(axis=0)
    scale = 1000.0/max(high[0] - low[0], high[1] - low[1])
    shapes = []
    for kind, nodes in grid.cells:
        for x in grid.points[nodes[:, :3 if "triangle" in kind else 4]]:
            shapes.append("M" + "L".join(f"{scale*(a - low[0]):.0f} {scale*(high[1] - b):.0f}" for a, b, _ in x) + "Z")
    return Picture("", "".join(shapes), tuple(scale*(high - low)[:2]))


def collect(pictures, width):
    """An SVG picture of drawn meshes side by side, four in a row, each of a width."""
    if not pictures:
        return '<svg xmlns="http://www.w3.org/2000/svg"/>\n'
    scale = width/max(1.0, pictures[0].size[0])
    # The font of a label, and the room around a panel.
    font, room = 13, 20 if pictures[0].label else 2
    across, down = width + room, scale*pictures[0].size[1] + (2 if pictures[0].label else 1)*room
    parts = []
    for number, picture in enumerate(pictures):
        x, y = (number % 4)*across + room/2, (number//4)*down + room/2
        if picture.label:
            parts.append(f'<text x="{x:.0f}" y="{y + font - 4:.0f}" font-family="sans-serif" font-size="{font}">'
                         f'{picture.label}</text>')
            y += room
        parts.append(f'<path transform="translate({x:.0f} {y:.0f}) scale({scale:.4f})" d="{picture.path}" fill="none" '
                     f'stroke="#345" stroke-width="{0.5/scale:.2f}"/>')
    columns, lines = min(4, len(pictures)), (len(pictures) + 3)//4
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {columns*across:.0f} {lines*down:.0f}">' \
        f'<rect width="100%" height="100%" fill="#fff"/>{"".join(parts)}</svg>\n'
