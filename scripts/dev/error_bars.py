#!/usr/bin/env python3
"""How often the error bars of refined meshes hold the true value, for closed forms that no page of the project has.

    AMONTONS=build/release/bin/amontons python3 -B scripts/dev/error_bars.py [--refine N] [--gmsh] [PROBLEM...]

For every quantity it prints how many bars hold the true value, the medians of the bars and of the true errors over this
value, and that of the ratio of both: bars many times the error would say nothing. Exit status: 0 if the bars hold the
true value on 95 of 100 meshes. K. L. Johnson, *Contact Mechanics*, has the closed forms, but for the tube's (Lame) and
the rounded punch's, which integrates the slope of its profile (section 5.3). Blocks are wide enough for their far sides
to matter less than the bars.
"""
import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

YOUNG, POISSON = 1000.0, 0.3
MODULUS = YOUNG/(1 - POISSON**2)
ELEMENTS = ("tri3", "quad4", "tri6", "quad8", "quad9")


class Problem:
    """A rectangle on an obstacle, its mesh aside, with the true values of key results."""

    def __init__(self, size, groups, exact, cells, line="", origin=0.0, hypothesis="plane strain"):
        self.size = size
        self.hypothesis = hypothesis
        self.groups = groups
        self.exact = exact
        self.cells = cells  # along the width
        self.line = line  # points of a polyline
        self.origin = origin

    def rectangle(self, element, n):
        """The &mesh of a regular mesh."""
        rows = max(1, round(n*self.size[1]/self.size[0]))
        diagonal = "alternating" if n % 2 else "right"
        return f"size = {self.size[0]}, {self.size[1]}  cells = {n}, {rows}  element = '{element}'  " \
            f"diagonal = '{diagonal}'  origin = {self.origin}, 0.0"

    def unstructured(self, element, n, folder):
        """The &mesh of one that Gmsh makes of the same number of elements along the width."""
        width, height = self.size
        corners = ((0, 0), (width, 0), (width, height), (0, height))
        lines = [f"Point({i}) = {{{self.origin + x}, {y}, 0, {width/n}}};" for i, (x, y) in enumerate(corners, 1)]
        for i, name in enumerate(("bottom", "right", "top", "left"), 1):
            lines += [f"Line({i}) = {{{i}, {i % 4 + 1}}};", f'Physical Curve("{name}") = {{{i}}};']
        lines += ["Curve Loop(1) = {1:4};", "Plane Surface(1) = {1};", 'Physical Surface("body") = {1};',
                  f"Mesh.ElementOrder = {1 if element in ('tri3', 'quad4') else 2};",
                  f"Mesh.SecondOrderIncomplete = {int(element == 'quad8')};", f"Mesh.RandomSeed = {n};"]
        if element.startswith("quad"):
            lines += ["Recombine Surface {1};", "Mesh.RecombinationAlgorithm = 3;"]
        Path(folder, "mesh.geo").write_text("\n".join(lines) + "\n", encoding="utf-8")
        subprocess.run(["gmsh", "-2", "-format", "msh41", "mesh.geo"], cwd=folder, check=True, capture_output=True)
        return "kind = 'file'  file = 'mesh.msh'"


def wave(share):
    """A block on a rigid wave of the length 2, under a part of the pressure that closes all gaps (section 13.2)."""
    length, height = 2.0, 0.01
    pressure = share*math.pi*MODULUS*height/length
    sine = math.sqrt(share)
    line = "".join(f"{x!r}, {height*(math.cos(2*math.pi*x/length) - 1)!r}\n"
                   for x in (length*(i/2000 - 1) for i in range(4001)))
    return Problem((0.5*length, 2*length), ("support set = 'left'  ux = 0.0", "support set = 'right'  ux = 0.0",
                   f"load set = 'top'  pressure = {pressure}", "contact set = 'bottom'  obstacle = 'polyline'"),
                   {"contact_width": length/math.pi*math.asin(sine), "max_contact_pressure": 2*pressure/sine},
                   (5, 6, 7, 8, 9, 10, 11), line)


def half_block(force, profile, exact, line="", cells=(11, 13, 16, 19, 20)):
    """Half of a block on a symmetric obstacle that makes a contact of the half width 1."""
    return Problem((12.0, 24.0), ("support set = 'left'  ux = 0.0", f"load set = 'top'  pressure = {force/24.0}",
                   f"contact set = 'bottom'  {profile}"), exact, cells, line)


def cylinder():
    """Half of a block on a cylinder of the radius 100 (section 4.2)."""
    force = math.pi*MODULUS/400
    return half_block(force, "obstacle = 'circle'  radius = 100.0",
                      {"contact_width": 1.0, "max_contact_pressure": 2*force/math.pi})


def whole_cylinder():
    """A whole block on the same cylinder: an odd number of cells puts the middle of the contact between two nodes."""
    force = math.pi*MODULUS/400
    return Problem((24.0, 24.0), ("support point = -12.0, 24.0  ux = 0.0", f"load set = 'top'  pressure = {force/24.0}",
                   "contact set = 'bottom'  obstacle = 'circle'  radius = 100.0"),
                   {"contact_width": 2.0, "max_contact_pressure": 2*force/math.pi}, (25, 28, 31, 36, 41, 44), "", -12.0)


def wedge():
    """A blunt wedge (section 5.2); the pressure has no largest value."""
    return half_block(0.01*MODULUS, "obstacle = 'polyline'", {"contact_width": 1.0},
                      "-50.0, -0.5\n0.0, 0.0\n50.0, -0.5\n")


def rounded_punch():
    """A flat punch of the half width 1/2, rounded to parabolas of the radius 50."""
    radius, flat = 50.0, 0.5
    angle = math.asin(flat)
    force = MODULUS/radius*(0.5*(math.pi/2 - angle) + 0.25*math.sin(2*angle) - flat*math.cos(angle))
    places = (-30, -20, -12, -8, *(i*0.002 - 5 for i in range(5001)), 8, 12, 20, 30)
    return half_block(force, "obstacle = 'polyline'", {"contact_width": 1.0},
                      "".join(f"{x!r}, {-max(0.0, abs(x) - flat)**2/(2*radius)!r}\n" for x in places))


def revolved(force, profile, exact, line=""):
    """A cylinder on an obstacle of revolution that makes a contact of the radius 1."""
    return Problem((10.0, 10.0), ("support set = 'left'  ux = 0.0",
                   f"load set = 'top'  pressure = {force/(100*math.pi)}", f"contact set = 'bottom'  {profile}"), exact,
                   (11, 13, 16, 19, 20, 23, 27), line, hypothesis="axisymmetric")


def sphere():
    """A sphere of the radius 100 (section 3.4)."""
    force = 4*MODULUS/300
    return revolved(force, "obstacle = 'parabola'  radius = 100.0",
                    {"contact_width": 1.0, "max_contact_pressure": 1.5*force/math.pi})


def cone():
    """A blunt cone (section 5.2); the pressure has no largest value."""
    return revolved(0.005*math.pi*MODULUS, "obstacle = 'polyline'", {"contact_width": 1.0},
                    "-20.0, -0.2\n0.0, 0.0\n20.0, -0.2\n")


def tube():
    """A thick tube on a rigid shaft that is too large for it."""
    inner, outer, excess = 1.0, 3.0, 0.001
    ratio = (outer**2 + inner**2)/(outer**2 - inner**2)
    pressure = excess*YOUNG/(inner*(ratio + POISSON))
    return Problem((outer - inner, 0.5), ("support set = 'bottom'  uy = 0.0", "contact set = 'left'  normal = 1.0, 0.0"
                   f"  point = {inner}, 0.0  extra_gap = {-excess}"),
                   {"max_contact_pressure": pressure, "max_von_mises": pressure*math.sqrt(1 + ratio + ratio**2)},
                   (4, 5, 7, 8, 10, 13), "", inner, "axisymmetric")


PROBLEMS = {"wave_08": wave(0.08), "wave_20": wave(0.2), "wave_45": wave(0.45), "wave_80": wave(0.8),
            "cylinder": cylinder(), "whole_cylinder": whole_cylinder(), "wedge": wedge(),
            "rounded_punch": rounded_punch(), "sphere": sphere(), "cone": cone(), "tube": tube()}


def main():
    """Prints every bar that misses, and the share that hold."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--refine", type=int, default=2, help="number of refinements")
    parser.add_argument("--gmsh", action="store_true", help="unstructured meshes by Gmsh instead of regular ones")
    parser.add_argument("problem", nargs="*", choices=[[], *PROBLEMS], help="the problems; default: all")
    options = parser.parse_args()
    held = []
    for name in options.problem or PROBLEMS:
        rows = {key: [] for key in PROBLEMS[name].exact}
        with tempfile.TemporaryDirectory() as folder:
            for element in ELEMENTS:
                for n in PROBLEMS[name].cells:
                    judge(rows, f"{name} {element} {n}", PROBLEMS[name],
                          solve(PROBLEMS[name], folder, options, element, n))
        for key, bars in rows.items():
            held += [error <= bar for bar, error in bars]
            print(f"{name:15} {key:21} {sum(error <= bar for bar, error in bars):3} of {len(bars)}; medians: bar "
                  f"{statistics.median(bar for bar, _ in bars):.1e}, error "
                  f"{statistics.median(error for _, error in bars):.1e}, ratio "
                  f"{statistics.median(bar/max(error, 1e-12) for bar, error in bars):.1f}", flush=True)
    print(f"{sum(held)} of {len(held)} bars hold the true value: {sum(held)/len(held):.1%}")
    return sum(held) < 0.95*len(held)


def judge(rows, label, problem, found):
    """Adds the bars of a case, and their true errors, both over the true value; prints those that miss."""
    for key, true in problem.exact.items():
        bar, error = found[key]["error_bar"]/true, abs(found[key]["values"][-1]/true - 1)
        rows[key].append((bar, error))
        if error > bar:
            print(f"{label}: {key} {found[key]['values'][-1]:.6g} +- {found[key]['error_bar']:.2g} "
                  f"({found[key]['verdict']}), true {true:.6g}")


def solve(problem, folder, options, element, n):
    """The numbers of a case on refined meshes."""
    mesh = problem.unstructured(element, n, folder) if options.gmsh else problem.rectangle(element, n)
    material = f"material young = {YOUNG}  poisson = {POISSON}  hypothesis = '{problem.hypothesis}'"
    deck = "".join(f"&{group} /\n" for group in (f"mesh {mesh}", material, *problem.groups))
    if problem.line:
        Path(folder, "line.csv").write_text(problem.line, encoding="utf-8")
        deck = deck.replace("'polyline'", "'polyline'  line = 'line.csv'")
    program = str(Path(os.environ["AMONTONS"]).resolve())
    subprocess.run([program, "--quiet", "--set", "case.name=case", "--refine", str(options.refine), "-"], cwd=folder,
                   input=deck, text=True, check=True)
    return json.loads(Path(folder, "case.summary.json").read_text(encoding="utf-8"))["convergence"]


if __name__ == "__main__":
    sys.exit(main())
