"""Solves random sound bodies by each contact method and prints how many each one fails on.

Usage: sound_bodies.py PROGRAM COUNT [FIRST [METHOD...]]

A body is sound if loads and obstacles leave it an equilibrium: supports hold it, or loads press it on its obstacles
within the cone of friction. Every second body is one of fuzz_bodies.py, the others are loose: nothing but contact
holds them, from obstacles far away to overlaps far larger than what the loads press in. Body number k is the same in
every run. A method fails where its residual stays above the tolerance, or where the certificate does not pass.
"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

import fuzz_bodies

BATCH = 100
METHODS = ("auto", "newton", "lemke", "splitting")


def loose_body(number):
    """The deck of a random body that contact alone holds, without its solver."""
    choice = random.Random(number)
    size = (10**choice.uniform(-0.3, 1.3), 10**choice.uniform(-0.5, 0.8))
    cells = (choice.randint(2, 40), choice.randint(1, 10))
    element = fuzz_bodies.one_of(choice, quad4=4, tri3=2, tri6=1, quad8=1, quad9=1)
    young = 10**choice.uniform(2, 5)
    pressure = young*10**choice.uniform(-7, -2)
    friction = choice.choice((0.1, 0.2, 0.3, 0.6, 1.0))
    # The resultant stays in the cone of friction, and in the middle half of the side.
    push = choice.uniform(-0.8, 0.8)*friction*pressure*size[0]/size[1]
    lever = 0.25*pressure*size[0]**2/(0.5*size[1]**2)
    push = max(-lever, min(lever, push))
    lines = [
        f"&mesh size = {size[0]:.6g}, {size[1]:.6g}  cells = {cells[0]}, {cells[1]}  element = '{element}' /",
        f"&material young = {young:.6g}  poisson = {choice.uniform(0.0, 0.45):.4g}"
        f"  hypothesis = '{choice.choice(('plane strain', 'plane stress'))}' /",
        f"&load set = 'left'  traction = {push:.6g}, 0.0 /",
        f"&load set = 'top'  pressure = {pressure:.6g}"
        f"  pressure_slope = {choice.uniform(-0.2, 0.2)*pressure/size[0]:.6g}, 0.0 /"
    ]
    overlap = choice.choice((-1, -1, 1))*size[1]*10**choice.uniform(-5, -1)
    kind = fuzz_bodies.one_of(choice, plane=3, circle=2, parabola=1)
    tilt = choice.uniform(-1e-2, 1e-2) if choice.random() < 0.5 else 0.0
    words = [f"&contact set = 'bottom'  friction = {friction}  extra_gap = {overlap:.6g}",
             f"point = {0.5*size[0]:.6g}, 0.0  obstacle = '{kind}'  normal = {tilt:.9g}, {1.0 - 0.5*tilt**2:.9g}"]
    if kind != "plane":
        # A hollow carries the body at its corners, a hump of small radius in its middle alone.
        words.append(f"radius = {-max(size)*10**choice.uniform(0.6, 3):.6g}")
    lines.append("  ".join(words) + " /")
    return "\n".join(lines)


def deck(number):
    """The deck of a body, without its solver."""
    return loose_body(number) if number % 2 else fuzz_bodies.body(number)[0]


def results(program, numbers, method):
    """Residual, verdict of the certificate and iterations of each body that the method was tried on."""
    found = {}
    with tempfile.TemporaryDirectory(prefix="sound_") as name:
        folder = pathlib.Path(name)
        for number in numbers:
            (folder/f"body_{number}.nml").write_text(f"{deck(number)}\n&solver method = '{method}' /\n")
        decks = [f"body_{number}.nml" for number in numbers]
        subprocess.run([program, "--output", "out", *decks], cwd=folder, capture_output=True, check=False)
        for number in numbers:
            path = folder/"out"/f"body_{number}.summary.json"
            if path.exists():
                found[number] = json.loads(path.read_text())
    return found


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    count = int(sys.argv[2])
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    methods = sys.argv[4:] or METHODS
    print("| method | bodies | not solved | certificate fails | iterations, median | most | failed bodies |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    n_failed = 0
    for method in methods:
        found = {}
        for start in range(first, first + count, BATCH):
            found |= results(program, range(start, min(start + BATCH, first + count)), method)
        unsolved = [k for k, result in found.items() if not result["converged"]]
        refused = [k for k, result in found.items() if result["converged"] and not result["certificate"]["passed"]]
        iterations = sorted(result["iterations"] for result in found.values())
        failed = " ".join(map(str, unsolved + refused))
        print(f"| {method} | {len(found)} | {len(unsolved)} | {len(refused)} | {iterations[len(iterations)//2]} "
              f"| {iterations[-1]} | {failed} |", flush=True)
        n_failed += len(unsolved) + len(refused) if method == "auto" else 0
    sys.exit(1 if n_failed else 0)


if __name__ == "__main__":
    main()
