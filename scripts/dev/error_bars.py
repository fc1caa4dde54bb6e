#!/usr/bin/env python3
"""How often the error bars of refined meshes hold the true value, for a closed form that no page of the project has.

    AMONTONS=build/release/bin/amontons python3 -B scripts/dev/error_bars.py [--refine N]

A block on a rigid wavy surface of the length L and the height 2 D (K. L. Johnson, *Contact Mechanics*, section 13.2):
under the mean pressure p the contact has the half width a, sin^2(pi a/L) = p/p*, p* = pi E* D/L, and the peak
2 p/sin(pi a/L).
Exit status: 0 if the bars hold the true value on 95 of 100 meshes.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

YOUNG, POISSON, WAVE, HEIGHT = 1000.0, 0.3, 2.0, 0.01
MODULUS = YOUNG/(1 - POISSON**2)
FULL = math.pi*MODULUS*HEIGHT/WAVE  # the pressure that closes all gaps
ELEMENTS = ("tri3", "quad4", "tri6", "quad8")
CELLS = (5, 6, 7, 8, 9, 10, 11)
DECK = """&mesh size = {width}, {depth}  cells = {n}, {rows}  element = '{element}' /
&material young = {young}  poisson = {poisson} /
&support set = 'left'  ux = 0.0 /
&support set = 'right'  ux = 0.0 /
&load set = 'top'  pressure = {pressure} /
&contact set = 'bottom'  obstacle = 'polyline'  line = 'wave.csv' /
"""


def main():
    """Prints every bar that misses, and the share that hold."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--refine", type=int, default=2, help="number of refinements")
    options = parser.parse_args()
    program = str(Path(os.environ["AMONTONS"]).resolve())
    held = total = 0
    with tempfile.TemporaryDirectory() as folder:
        points = [WAVE*(i/400 - 1) for i in range(801)]
        Path(folder, "wave.csv").write_text("".join(
            f"{s!r}, {HEIGHT*(math.cos(2*math.pi*s/WAVE) - 1)!r}\n" for s in points), encoding="utf-8")
        for share in (0.2, 0.45):
            exact = closed_form(share*FULL)
            for element in ELEMENTS:
                for n in CELLS:
                    found = solve(program, folder, options.refine, element, n, share*FULL)
                    for key, value in exact.items():
                        total += 1
                        miss = abs(found[key]["values"][-1] - value)
                        is_held = miss <= found[key]["error_bar"]
                        held += is_held
                        if not is_held:
                            print(f"{element:6} {n:3} cells, p/p* = {share}: {key} {found[key]['values'][-1]:.6g} +- "
                                  f"{found[key]['error_bar']:.2g} ({found[key]['verdict']}), true {value:.6g}")
    print(f"{held} of {total} bars hold the true value: {held/total:.1%}")
    return held < 0.95*total


def closed_form(pressure):
    """The true values of the key results."""
    sine = math.sqrt(pressure/FULL)
    return {"contact_width": WAVE/math.pi*math.asin(sine), "max_contact_pressure": 2*pressure/sine}


def solve(program, folder, refinements, element, n, pressure):
    """The numbers of a case on refined meshes."""
    deck = DECK.format(width=0.5*WAVE, depth=2*WAVE, n=n, rows=4*n, element=element, young=YOUNG, poisson=POISSON,
                       pressure=pressure)
    subprocess.run([program, "--quiet", "--set", "case.name=wave", "--set", f"accuracy.refinements={refinements}", "-"],
                   cwd=folder, input=deck, text=True, check=True)
    return json.loads(Path(folder, "wave.summary.json").read_text(encoding="utf-8"))["convergence"]


if __name__ == "__main__":
    sys.exit(main())
