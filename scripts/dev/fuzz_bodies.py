"""Solves random sound bodies by two routes and fails where these disagree.

Usage: fuzz_bodies.py PROGRAM COUNT [FIRST [METHOD]]

One route condenses the stiffness to a dense matrix of the contact points, the other one leaves it a band matrix of the
whole body (`condensation`, see doc/decks.md): of the contact forces they share the friction law alone. Body number k is
the same in every run. Every body has a solution: supports hold it, or its loads press it on its obstacles. METHOD is
the contact method of the dense route, auto unless given. What goes wrong is kept in build/fuzz and printed.
"""

import csv
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BATCH = 50
SECONDS_A_BATCH = 600
# Residuals of 1e-10 of the largest force at one point; soft modes of a slender body make more of them.
TOLERANCE = 1e-6
ROUTES = ("dense", "band")


def one_of(choice, **words):
    """One of some words, by their weights."""
    return choice.choices(list(words), list(words.values()))[0]


def contact_group(choice, side, size, overlap):
    """The contact set of a side of the rectangle, its obstacle close to it."""
    point, normal = {
        "bottom": ((0.5*size[0], 0.0), (0.0, 1.0)),
        "top": ((0.5*size[0], size[1]), (0.0, -1.0)),
        "left": ((0.0, 0.5*size[1]), (1.0, 0.0))
    }[side]
    friction = choice.choice((0.0, 0.1, 0.3, 0.6, 1.0)) if choice.random() < 0.7 else choice.uniform(0.0, 1.0)
    words = [f"&contact set = '{side}'  friction = {friction}  extra_gap = {overlap:.6g}"]
    kind = one_of(choice, plane=6, circle=2, parabola=1)
    tilt = choice.uniform(-1e-3, 1e-3) if choice.random() < 0.3 else 0.0
    words.append(f"point = {point[0]:.6g}, {point[1]:.6g}  obstacle = '{kind}'")
    words.append(f"normal = {normal[0] + tilt*normal[1]:.9g}, {normal[1] - tilt*normal[0]:.9g}")
    if kind != "plane":
        sign = choice.choice((1, 1, -1))
        # An arc as deep as a slender body is high would contain it.
        radius = max(max(size)*10**choice.uniform(0.6, 3), 0.5*size[0]**2/size[1] if side != "left" else 0.0)
        words.append(f"radius = {sign*radius:.6g}")
    if choice.random() < 0.15:
        words.append(f"slip_bound = {10**choice.uniform(-2, 0):.6g}")
    return "  ".join(words) + " /"


def body(number):
    """The deck of a random body, without its solver; and a force that is small beside its loads."""
    choice = random.Random(number)
    size = (10**choice.uniform(0, 1.5), 10**choice.uniform(-0.5, 0.8))
    cells = (choice.randint(2, 40), choice.randint(1, 8))
    element = one_of(choice, quad4=4, tri3=2, tri6=1, quad8=1, quad9=1)
    young = 10**choice.uniform(2, 5)
    # Stresses of about a thousandth of the modulus and gaps to match keep strains small.
    stress = 1e-3*young
    gap = 1e-3*size[1]
    lines = [
        f"&mesh size = {size[0]:.6g}, {size[1]:.6g}  cells = {cells[0]}, {cells[1]}  element = '{element}' /",
        f"&material young = {young:.6g}  poisson = {choice.uniform(0.0, 0.45):.4g}"
        f"  hypothesis = '{one_of(choice, **{'plane strain': 1, 'plane stress': 1})}' /"
    ]
    hold = one_of(choice, clamped=3, guided=3, wedged=2, free=2)
    push = choice.uniform(-1, 1)*stress
    if hold == "clamped":
        # Stiff springs: a corner that is held at rest may lie in an obstacle, which is refused.
        stiff = 100*young/size[0]
        lines.append(f"&support set = 'right'  spring_n = {stiff:.6g}  spring_t = {stiff:.6g} /")
        lines.append(f"&load set = 'left'  traction = {push:.6g}, {choice.uniform(-0.1, 0.1)*stress:.6g} /")
    elif hold == "guided":
        lines.append("&support set = 'right'  ux = 0.0 /")
        lines.append(f"&load set = 'left'  traction = {push:.6g}, 0.0 /")
    sides = {"clamped": ["bottom", "top"], "guided": ["bottom"], "wedged": ["bottom", "top"], "free": ["bottom"]}[hold]
    if hold == "clamped" and choice.random() < 0.5:
        sides.pop()
    if hold == "wedged":
        lines.append("&support set = 'right'  ux = 0.0 /")
        lines.append(f"&load set = 'left'  traction = {push:.6g}, 0.0 /")
    if hold == "free":
        # Friction or springs would have to bear any push: springs along the side do.
        lines.append(f"&support set = 'right'  spring_n = {0.1*young/size[0]:.6g} /")
        lines.append(f"&load set = 'left'  traction = {push:.6g}, 0.0 /")
    if "top" not in sides:
        lines.append(f"&load set = 'top'  pressure = {choice.uniform(0.2, 2)*stress:.6g}"
                     f"  pressure_slope = {choice.uniform(-0.1, 0.1)*stress/size[0]:.6g}, 0.0 /")
    for side in sides:
        overlap = choice.uniform(-1, 0.5)*gap
        if hold == "wedged":
            overlap = -choice.uniform(0.2, 1)*gap
        lines.append(contact_group(choice, side, size, overlap))
    return "\n".join(lines), 1e-3*stress*size[1]/cells[1]


def forces(folder, name):
    """The contact forces of a case, and its statuses."""
    with open(folder/f"{name}.contact.csv", encoding="ascii") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    values = [float(row[column]) for row in rows for column in ("normal_force", "tangential_force")]
    return values, [row["status"] for row in rows]


def disagreement(folder, name, small_force):
    """What is wrong with the results of a body, or None; and whether it has two solutions."""
    found = []
    for route in ROUTES:
        summary = folder/f"{name}_{route}.summary.json"
        if not summary.exists():
            return f"no result of the {route} route", False
        if not json.loads(summary.read_text())["converged"]:
            return f"not solved by the {route} route", False
        found.append(forces(folder, f"{name}_{route}"))
    (left, left_status), (right, right_status) = found
    largest = max(max(map(abs, left)), max(map(abs, right)), small_force)
    difference = max(abs(a - b) for a, b in zip(left, right))/largest
    if difference <= TOLERANCE:
        return None, False
    # Strong friction allows several solutions; nothing else does.
    unique = json.loads((folder/f"{name}_dense.summary.json").read_text())["uniqueness"]["guaranteed"]
    if left_status != right_status and not unique and not math.isnan(difference):
        return None, True
    return f"forces differ by {difference:.1e}", False


def run_batch(program, numbers, method):
    """Solves some bodies; returns the faults and how many have two solutions."""
    faults, n_several = [], 0
    with tempfile.TemporaryDirectory(prefix="fuzz_") as name:
        folder = pathlib.Path(name)
        decks, small = [], {}
        for number in numbers:
            text, small[number] = body(number)
            for route in ROUTES:
                path = folder/f"body_{number}_{route}.nml"
                chosen = method if route == "dense" else "auto"
                path.write_text(f"{text}\n&solver method = '{chosen}'  condensation = '{route}' /\n")
                decks.append(path.name)
        process = subprocess.run([program, "--output", "out", *decks], cwd=folder, capture_output=True, text=True,
                                 timeout=SECONDS_A_BATCH, check=False)
        if process.returncode not in (0, 4):
            print(process.stderr, end="")
        for number in numbers:
            fault, is_several = disagreement(folder/"out", f"body_{number}", small[number])
            n_several += is_several
            if fault:
                keep = ROOT/"build"/"fuzz"
                keep.mkdir(parents=True, exist_ok=True)
                for route in ROUTES:
                    shutil.copy(folder/f"body_{number}_{route}.nml", keep)
                faults.append(f"body {number}: {fault}; build/fuzz/body_{number}_*.nml")
    return faults, n_several


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    count = int(sys.argv[2])
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    method = sys.argv[4] if len(sys.argv) > 4 else "auto"
    n_faults = n_several = 0
    for start in range(first, first + count, BATCH):
        faults, several = run_batch(program, range(start, min(start + BATCH, first + count)), method)
        for fault in faults:
            print(fault, flush=True)
        n_faults += len(faults)
        n_several += several
    print(f"bodies: {count} from number {first} on, {n_faults} faults, {n_several} with two solutions")
    sys.exit(1 if n_faults else 0)


if __name__ == "__main__":
    main()
