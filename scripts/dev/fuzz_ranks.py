"""Solves random bodies over ranks of MPI and on one, and fails where these disagree.

Usage: fuzz_ranks.py PROGRAM COUNT [FIRST [RANKS...]]

Bodies are those of fuzz_bodies.py, bodies of revolution, heated, spinning and heavy ones, and stacks of bodies in
contact with and bonded to each other, of all elements; some under a sweep, some with a history. Of PROGRAM, built with
MPI, one run takes the program's own factorizations and the others spread every body over RANKS, 2, 3 and 5 unless
given; what they wrote must be verified as that of one rank is. All numbers of all tables and the displacements of the
grids must agree to 1e-9 of the largest of their column. Where strong friction allows several solutions they need not.
Body number k is the same in every run. What goes wrong is kept in build/fuzz and printed.
"""

import csv
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

import fuzz_bodies

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT/"tests"/"app"))
os.environ.setdefault("AMONTONS", sys.argv[1])
# pylint: disable-next=wrong-import-position
from harness import read_vtu  # noqa: E402

BATCH = 40
TOLERANCE = 1e-9
# Columns that tell of the way to an answer, of rounding, or of statuses, which change where a point is on its bound.
WAYS = re.compile(r"iterations|residual|violation|error|status|converged|certif|identity|indicator|start_|stage|method"
                  r"|order|open_length|slip_length|stick_length")
NUMBER = re.compile(r"-?[0-9.]+(e[-+]?[0-9]+)?")
ELEMENTS = {"quad4": 4, "tri3": 2, "tri6": 1, "quad8": 1, "quad9": 1}
os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1",
                  OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_hwloc_base_binding_policy="none")


def rectangle(choice, name, size, origin):
    """The mesh of a body of a stack, sometimes of fewer cells than there are ranks."""
    cells = choice.randint(1, 16), choice.randint(1, 5)
    if not name:
        cells = choice.randint(2, 16), cells[1]
    label = f"name = '{name}'  " if name else ""
    return (f"&mesh {label}size = {size[0]:.6g}, {size[1]:.6g}  cells = {cells[0]}, {cells[1]}  element = "
            f"'{fuzz_bodies.one_of(choice, **ELEMENTS)}'  origin = {origin[0]:.6g}, {origin[1]:.6g} /")


def actions(choice, young, prefix, has_speed):
    """Loads of all kinds that press a body down, their stresses about a thousandth of its modulus."""
    stress = 1e-3*young
    lines = [f"&load name = 'p'  set = '{prefix}top'  pressure = {choice.uniform(0.3, 2)*stress:.6g} /",
             f"&load name = 'q'  set = '{prefix}right'  traction = {choice.uniform(-0.3, 0.3)*stress:.6g}, 0.0 /"]
    if choice.random() < 0.4:
        lines.append(f"&load temperature = {choice.uniform(-20, 20):.6g}"
                     f"  temperature_slope = {choice.uniform(-3, 3):.6g}, {choice.uniform(-3, 3):.6g} /")
    if choice.random() < 0.3:
        lines.append(f"&load gravity = 0.0, {-choice.uniform(0, 0.2)*stress:.6g} /")
    if has_speed and choice.random() < 0.5:
        lines.append(f"&load angular_speed = {(choice.uniform(0, 0.02)*stress)**0.5:.6g} /")
    return lines


def revolved_body(choice):
    """A body of one mesh: plane or of revolution, with every kind of load, on an obstacle below it."""
    young = 10**choice.uniform(2, 5)
    hypothesis = fuzz_bodies.one_of(choice, **{"axisymmetric": 2, "plane strain": 1, "plane stress": 1})
    size = 10**choice.uniform(0, 1), 10**choice.uniform(-0.3, 0.7)
    origin = (choice.choice((0.0, size[0])), 0.0)
    poisson = choice.choice((0.0, 0.3, 0.495))
    lines = [rectangle(choice, "", size, origin),
             f"&material young = {young:.6g}  poisson = {poisson}  hypothesis = '{hypothesis}'  density = 1.0"
             f"  expansion = {choice.uniform(0, 2e-5):.3g} /"]
    lines += actions(choice, young, "", True)
    lines.append("&support set = 'left'  ux = 0.0 /" if hypothesis != "axisymmetric" or origin[0] == 0.0 else
                 f"&support set = 'left'  spring_n = {0.1*young/size[0]:.6g} /")
    if choice.random() < 0.3:
        modulus = f"{0.05*young/size[1]:.6g}"
        lines.append(f"&support set = 'top'  spring_t = {modulus}  spring_n = {modulus} /")
    multipliers = choice.choice(("", "", "  multipliers = 'constant'", "  multipliers = 'mortar'"))
    lines.append(f"&contact set = 'bottom'  friction = {choice.choice((0.0, 0.2, 0.5)):.3g}"
                 f"  extra_gap = {choice.uniform(-1e-3, 5e-4)*size[1]:.6g}{multipliers} /")
    return lines, "bottom"


def stack(choice):
    """Two or three bodies on each other, bonded or in contact, the lowest held or on a rigid plane."""
    young = 10**choice.uniform(2, 5)
    width, height, names = 10**choice.uniform(0, 1), 0.0, "abc"[:choice.randint(2, 3)]
    lines, sets = [], []
    for i, name in enumerate(names):
        size = (width, 10**choice.uniform(-0.3, 0.3))
        lines.append(rectangle(choice, name, size, (0.0, height)))
        lines.append(f"&material region = '{name}'  young = {young*10**choice.uniform(-0.5, 0.5):.6g}"
                     f"  poisson = {choice.uniform(0, 0.45):.4g}  density = 1.0  expansion = 1.0e-5 /")
        lines.append(f"&support set = '{name}.left'  ux = 0.0 /")
        height += size[1]
        if i == 0:
            continue
        pair = [f"{name}.bottom", f"{names[i - 1]}.top"]
        if choice.random() < 0.5:
            pair.reverse()
        if choice.random() < 0.35:
            lines.append(f"&tie set = '{pair[0]}'  to = '{pair[1]}' /")
            continue
        sets.append(pair[0])
        multipliers = choice.choice(("", "", "", "  multipliers = 'constant'"))
        lines.append(f"&contact set = '{pair[0]}'  against = '{pair[1]}'  friction = {choice.choice((0.0, 0.2, 0.5))}"
                     f"{multipliers} /")
    if choice.random() < 0.5 or not sets:
        lines.append(f"&contact set = '{names[0]}.bottom'  friction = 0.3 /")
        sets.append(f"{names[0]}.bottom")
    else:
        lines.append(f"&support set = '{names[0]}.bottom'  uy = 0.0 /")
    return lines + actions(choice, young, f"{names[-1]}.", False), sets[0]


def deck(number):
    """The deck of a random body, without its solver."""
    choice = random.Random(f"ranks {number}")
    kind = fuzz_bodies.one_of(choice, plain=3, revolved=3, stack=4)
    if kind == "plain":
        return fuzz_bodies.body(number)[0]
    lines, contact = revolved_body(choice) if kind == "revolved" else stack(choice)
    study = fuzz_bodies.one_of(choice, case=6, sweep=2, history=2, refined=1)
    if study == "sweep":
        # Cases of two chunks, so that ranks share them, or few with results that take the whole body.
        is_shared = choice.random() < 0.6
        lines.append(f"&sweep load = 'q'  factor = -1.0, 1.0  count = {40 if is_shared else 4} /")
        lines.append(f"&sweep contact = '{contact}'  friction_factor = 0.5, 1.0 /")
        lines.append(f"&output key_results = '{'contact' if is_shared else 'all'}'"
                     f"  fields_every = {30 if is_shared else 3} /")
    elif study == "history":
        lines.append("&history times = 0.0, 1.0, 2.0, 3.0  substeps = 2 /")
        lines.append("&steps load = 'p'  factor = 0.0, 1.0, 1.0, 1.0 /")
        lines.append("&steps load = 'q'  factor = 0.0, 0.0, 1.0, -0.5 /")
    elif study == "refined":
        lines.append("&accuracy refinements = 2 /")
    return "\n".join(lines)


def numbers_of(path):
    """The numbers of a file of results, column by column."""
    if path.suffix == ".vtu":
        grid = read_vtu(path.read_bytes())[0]
        return {"displacement": [u for node in grid["displacement"] for u in node]}
    lines = (line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    table = list(csv.DictReader(lines))
    columns = {column: [row[column] for row in table] for column in (table[0] if table else [])}
    return {column: list(map(float, values)) for column, values in columns.items()
            if not WAYS.search(column) and all(map(NUMBER.fullmatch, values))}


def worst_of(one, other):
    """The largest difference of the numbers of two files, each over the largest of its kind, and where it is."""
    left, right = numbers_of(one), numbers_of(other)
    if {key: len(values) for key, values in left.items()} != {key: len(values) for key, values in right.items()}:
        return 1.0, f"{one.name}: other rows or columns"
    grid = one.parent/f"{one.name.split('.', maxsplit=1)[0]}.vtu"
    moved = max(map(abs, numbers_of(grid)["displacement"]), default=0.0) if grid.exists() else 0.0
    found = [(max((abs(a - b) for a, b in zip(values, right[key])), default=0.0)
              / max(max(map(abs, values), default=0.0), 1e-290), f"{one.name}: {key}")
             for key, values in left.items() if scale_matters(key, left, moved)]
    return max(found, default=(0.0, one.name))


def scale_matters(column, columns, moved):
    """Whether a column is more than rounding beside its kind: shear beside pressure, one component beside the other."""
    own = max(map(abs, columns[column]), default=0.0)
    of_works = {"wear_integral": "contact_pressure", "dissipation": "normal_force"}
    if column in of_works and "contact_pressure" in columns:
        return own > 1e-6*moved*max(map(abs, columns[of_works[column]]), default=0.0)
    # Where a loose body without load is, rounding chooses on any factorization, and with it the work that closes it.
    if column == "closing_loss" or column == "work_loads" and is_closed_from_afar(columns):
        return False
    kinds = ("force", "stress", "pressure", "shear", "displacement", "slip", "gap", "energy", "work", "dissipation",
             "reaction", "tie_")
    kind = next((kind for kind in kinds if kind in column), None)
    if kind is None:
        return True
    kind = {"pressure": "stress", "shear": "stress", "slip": "displacement", "gap": "displacement",
            "energy": "work", "dissipation": "work", "reaction": "force", "tie_": "force"}.get(kind, kind)
    largest = max((abs(value) for key, values in columns.items() if kind in key for value in values), default=0.0)
    return own > 1e-6*max(largest, moved if kind == "displacement" else 0.0)


def is_closed_from_afar(columns):
    """Whether a step of a history closed a gap that no load had kept open."""
    loss, work = (max(map(abs, columns.get(key, [])), default=0.0) for key in ("closing_loss", "work_loads"))
    return loss > TOLERANCE*work


def run_batch(program, numbers, all_ranks):
    """Solves some bodies on all numbers of ranks.

    Returns the faults, how many runs found another one of several solutions, how many were spread, and the largest
    difference of the others.
    """
    faults, n_several, n_spread, worst = [], 0, 0, 0.0
    with tempfile.TemporaryDirectory(prefix="fuzz_") as name:
        folder = pathlib.Path(name)
        decks = [f"body_{number}.nml" for number in numbers]
        for number, path in zip(numbers, decks):
            (folder/path).write_text(deck(number) + "\n", encoding="utf-8")
        spread = ["--set", "solver.factorization=distributed"]
        runs = {1: [program, "--output", "on_1", *decks]}
        for n in all_ranks:
            runs[n] = ["mpiexec", "--quiet", "--oversubscribe", "-n", str(n), program, *spread, "--output", f"on_{n}",
                       *decks]
        told = {n: subprocess.run(run, cwd=folder, capture_output=True, encoding="utf-8", timeout=1200, check=False)
                for n, run in runs.items()}
        verified = {n: subprocess.run([program, "--verify", f"on_{n}"], cwd=folder, capture_output=True, timeout=1200,
                                      encoding="utf-8", check=False) for n in runs}
        for n in all_ranks:
            if verified[n].returncode != verified[1].returncode:
                faults.append(f"--verify of {n} ranks: {verified[n].stderr}")
            if told[n].returncode != told[1].returncode:
                faults.append(f"status {told[n].returncode} on {n} ranks, {told[1].returncode} on one")
            for number in numbers:
                files = {k: sorted(path.name for path in folder.glob(f"on_{k}/body_{number}.*")) for k in (1, n)}
                if files[1] != files[n]:
                    faults.append(keep(folder, number, f"{n} ranks: other files"))
                    continue
                compared = [worst_of(folder/"on_1"/file, folder/f"on_{n}"/file) for file in files[1]
                            if file.endswith((".csv", ".vtu")) and ".states." not in file]
                difference, where = max(compared, default=(0.0, ""))
                if difference <= TOLERANCE:
                    worst = max(worst, difference)
                elif is_unique(folder/"on_1"/f"body_{number}.summary.json"):
                    faults.append(keep(folder, number, f"{n} ranks: {where} differs by {difference:.1e}"))
                else:
                    n_several += 1
                listing = folder/f"on_{n}"/f"body_{number}.lst"
                n_spread += listing.exists() and " distributed, " in listing.read_text(encoding="utf-8")
    return faults, n_several, n_spread, worst


def is_unique(summary):
    """Whether all runs must agree: not where friction allows several solutions and the one found satisfies all laws."""
    told = json.loads(summary.read_text(encoding="utf-8"))
    return not told["certificate"]["passed"] or told.get("uniqueness", {}).get("guaranteed", True)


def keep(folder, number, fault):
    """Keeps the deck of a fault."""
    target = ROOT/"build"/"fuzz"
    target.mkdir(parents=True, exist_ok=True)
    shutil.copy(folder/f"body_{number}.nml", target/f"ranks_{number}.nml")
    return f"body {number}, build/fuzz/ranks_{number}.nml, on {fault}"


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    count = int(sys.argv[2])
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    ranks = [int(word) for word in sys.argv[4:]] or [2, 3, 5]
    n_faults = n_several = n_spread = 0
    worst = 0.0
    for start in range(first, first + count, BATCH):
        faults, several, spread, largest = run_batch(program, range(start, min(start + BATCH, first + count)), ranks)
        for fault in faults:
            print(fault, flush=True)
        n_faults, n_several, n_spread = n_faults + len(faults), n_several + several, n_spread + spread
        worst = max(worst, largest)
    print(f"bodies: {count} from number {first} on; {n_spread} runs spread, {n_faults} faults, {n_several} with another"
          f" one of several solutions; the others differ by {worst:.1e} at most")
    sys.exit(1 if n_faults else 0)


if __name__ == "__main__":
    main()
