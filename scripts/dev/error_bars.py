#!/usr/bin/env python3
"""How often the error bars of refined meshes hold the true value, for closed forms that no page of the project has.

    AMONTONS=build/release/bin/amontons python3 -B scripts/dev/error_bars.py [--refine N] [--gmsh] [PROBLEM...]

For every quantity it prints how many bars hold the true value, the medians of the bars and of the true errors over this
value, and that of the ratio of both: bars many times the error would say nothing. Exit status: 0 if the bars hold the
true value on 95 of 100 meshes. The closed forms are in closed_forms.py.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from closed_forms import PROBLEMS


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
            for element in PROBLEMS[name].elements:
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
    meshes = [f"mesh {mesh}" for mesh in problem.meshes(element, n, folder, options.gmsh)]
    deck = "".join(f"&{group} /\n" for group in (*meshes, *problem.materials(), *problem.groups))
    if problem.line:
        Path(folder, "line.csv").write_text(problem.line, encoding="utf-8")
        deck = deck.replace("'polyline'", "'polyline'  line = 'line.csv'")
    program = str(Path(os.environ["AMONTONS"]).resolve())
    subprocess.run([program, "--quiet", "--set", "case.name=case", "--refine", str(options.refine), "-"], cwd=folder,
                   input=deck, text=True, check=True)
    return json.loads(Path(folder, "case.summary.json").read_text(encoding="utf-8"))["convergence"]


if __name__ == "__main__":
    sys.exit(main())
