"""Measures Amontons and prints Markdown tables. Usage: bench.py BUILD-FOLDER WORK-FOLDER [--full].

Everything that doc/performance.md states is printed here. scripts/bench.sh builds first and calls this.
"""

import datetime
import json
import math
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BENCH = ROOT / "bench"
# The peers are Debian packages of Debian's own Python.
PYTHON = "/usr/bin/python3"
# But felupe, from PyPI, in an environment of its own (scripts/bench.sh).
FELUPE = ROOT / "build/felupe/bin/python"


def run(command, threads=None, check=True):
    """Runs a command; returns its output and the wall time, processor time [s] and peak memory [MB] it took."""
    environment = dict(os.environ)
    if threads:
        environment["OMP_NUM_THREADS"] = str(threads)
    start = time.perf_counter()
    process = subprocess.Popen([str(word) for word in command], env=environment, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    output = process.stdout.read()
    _, status, used = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    if check and os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"bench: {' '.join(map(str, command))} failed:\n{output}")
    return output, {"wall": wall, "cpu": used.ru_utime + used.ru_stime, "mb": used.ru_maxrss / 1000.0}


def best_of(n_trials, command, threads=None):
    """The run with the least wall time."""
    return min((run(command, threads)[1] for _ in range(n_trials)), key=lambda used: used["wall"])


def table(title, header, rows):
    print(f"\n### {title}\n\n| {' | '.join(header)} |\n|{'---:|' * len(header)}")
    for row in rows:
        print(f"| {' | '.join(row)} |")
    sys.stdout.flush()


def seconds(value):
    return f"{value:.2f}" if value >= 0.1 else f"{value:.2g}"


def long_bar_decks(folder, cells):
    """The five decks of Table 1 on other cells."""
    folder.mkdir(parents=True, exist_ok=True)
    decks = []
    for row in range(1, 6):
        text = (ROOT / "input" / f"long_bar_{row}.nml").read_text()
        deck = folder / f"long_bar_{row}.nml"
        deck.write_text(re.sub(r"cells = \d+, \d+", f"cells = {cells[0]}, {cells[1]}", text))
        decks.append(deck)
    return decks


def version_of(package):
    query = ["dpkg-query", "--show", "--showformat", "${Version}", package]
    return subprocess.run(query, capture_output=True, text=True, check=False).stdout or None


def print_machine(build):
    processor = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    rates = dict(line.split() for line in run([build / "bin/amontons_rates"])[0].splitlines())
    print("### Machine\n")
    print(f"* measured on {datetime.date.today().isoformat()}")
    print(f"* {processor.group(1) if processor else 'processor unknown'}, {len(os.sched_getaffinity(0))} cores")
    print(f"* {run(['gfortran', '--version'])[0].splitlines()[0]}")
    for package in ("libopenblas0-pthread", "libsuitesparse-dev", "python3-getfem", "calculix-ccx", "python3-siconos"):
        print(f"* {package} {version_of(package) or 'not installed'}")
    print(f"* matrix product on one core: {rates['dgemm_gflops']} Gflop/s")
    print(f"* memory traffic: {rates['bandwidth_one_gbytes']} GB/s from one core, "
          f"{rates['bandwidth_all_gbytes']} GB/s from all")
    return {name: float(rate) for name, rate in rates.items()}


def print_long_bar(program, work, sizes, rates):
    """Times of the five rows in one command, and of the phases of its first."""
    phases, totals = [], []
    times = {}
    for n in sizes:
        decks = long_bar_decks(work / f"bar_{n}", (n, n))
        output = work / f"bar_{n}"
        n_trials = 3 if n <= 256 else 1
        one = best_of(n_trials, [program, "--quiet", "--threads", "1", "--output", output, *decks])
        all_cores = best_of(n_trials, [program, "--quiet", "--output", output, *decks])
        cases = [json.loads((output / f"{deck.stem}.summary.json").read_text()) for deck in decks]
        first = cases[0]["seconds"]
        times[n] = {"factorize": first["factorize"], "total": all_cores["wall"]}
        rest = [sum(case["seconds"][phase] for case in cases[1:]) / 4 for phase in ("condense", "solve", "recover", "write")]
        totals.append([str(n), str(cases[0]["counts"]["dofs"]), seconds(one["wall"]), seconds(all_cores["wall"]),
                       seconds(all_cores["cpu"]), f"{all_cores['mb']:.0f}", seconds(sum(rest))])
        flops = cases[0]["factor"]["flops"]
        rate = flops / first["factorize"] * 1e-9
        phases.append([str(n)] + [seconds(first[name]) for name in
                      ("read", "assemble", "factorize", "condense", "solve", "recover", "write")] + [f"{rate:.1f}", f"{100 * rate / rates['dgemm_gflops']:.0f} %"])
    table("The five rows of Table 1 on n x n cells, one command", ["n", "unknowns", "one thread s", "all cores s",
          "processor s", "memory MB", "each further row s"], totals)
    table("Phases of the first row, all cores", ["n", "read s", "assemble s", "factorize s", "condense s", "solve s",
          "recover s", "write s", "Gflop/s", "of one core's dgemm"], phases)
    sizes = sorted(times)
    rows = [[f"{a} to {b}"] + [f"{math.log(times[b][what] / times[a][what], b / a):.2f}" for what in ("factorize", "total")]
            for a, b in zip(sizes, sizes[1:])]
    table("Growth: exponent of n (2 is linear in the number of unknowns, 3 the least for a factorization)",
          ["n", "factorize", "whole command"], rows)


def strip_deck(folder, length):
    """A strip of two cells' height between a rough floor and a rough ceiling, that lies on the floor and is pulled at its
    right end so that it slides over a third of its length."""
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / f"strip_{length}.nml"
    deck.write_text(f"""&mesh size = {length}.0, 2.0  cells = {length}, 2 /
&material young = 100000.0  poisson = 0.3  hypothesis = 'plane stress' /
&support set = 'left'  ux = 0.0 /
&load set = 'right'  traction = {0.05 * length}, 0.0 /
&load body_force = 0.0, -0.5 /
&contact set = 'bottom'  friction = 0.3 /
&contact set = 'top'  friction = 0.3  point = 0.0, 2.0  normal = 0.0, -1.0 /
""")
    return deck


def print_strips(program, work, lengths):
    """Long contact lines, beside squares of as many unknowns."""
    rows = []
    first = None
    for length in lengths:
        deck = strip_deck(work / "strips", length)
        command = [program, "--quiet", "--threads", "1", "--output", work / "strips"]
        used = best_of(3, [*command, deck])
        result = json.loads((work / "strips" / f"{deck.stem}.summary.json").read_text())
        counts = result["counts"]
        side = round(math.sqrt(counts["dofs"] / 2))
        square = best_of(3, [*command, long_bar_decks(work / f"bar_{side}", (side, side))[0]])
        per_point = used["cpu"] / counts["contact_points"]
        first = first or per_point
        rows.append([str(counts["contact_points"]), str(counts["dofs"]), str(result["iterations"]), seconds(used["cpu"]),
                     f"{used['mb']:.0f}", f"{per_point / first:.2f}", seconds(square["cpu"]),
                     f"{used['cpu'] / square['cpu']:.1f}"])
    table("Long contact lines: strips with contact above and below, processor time of the whole command on one thread",
          ["contact points", "unknowns", "iterations", "s", "memory MB", "s per point, over the first row's",
           "square of as many unknowns s", "times"], rows)


def pair_decks(folder, n):
    """Decks of n x n cells in all: a block on a floor of one mesh, of two that are bonded, and two blocks in contact, each
    with n + 1 contact points; the long bar of one body on the floor, and on a block of as many unknowns as itself."""
    folder.mkdir(parents=True, exist_ok=True)
    half = n // 2
    material = "&material young = 13000.0  poisson = 0.2 /\n"
    one = f"&mesh size = 40.0, 40.0  cells = {n}, {n} /\n"
    two = (f"&mesh name = 'upper'  size = 40.0, 20.0  cells = {n}, {half}  origin = 0.0, 20.0 /\n"
           f"&mesh name = 'lower'  size = 40.0, 20.0  cells = {n}, {half} /\n")
    loads = "&load set = '{0}left'  traction = 1.0, 0.0 /\n&load set = '{0}top'  traction = 0.0, -5.0 /\n"
    sides = "&support set = '{0}right'  ux = 0.0 /\n"
    upper, lower = sides.format("upper."), sides.format("lower.")
    floor = "&contact set = '{0}bottom'  friction = 0.5 /\n"
    bar = "&load set = '{0}left'  traction = 10.0, 0.0 /\n&load set = '{0}top'  traction = 0.0, -5.0 /\n"
    texts = {
        "joined": one + material + sides.format("") + loads.format("") + floor.format(""),
        "bonded": two + material + upper + lower + loads.format("upper.") + floor.format("lower.")
        + "&tie set = 'upper.bottom'  to = 'lower.top' /\n",
        "contact": two + material + upper + lower + loads.format("upper.")
        + "&support set = 'lower.bottom'  ux = 0.0  uy = 0.0 /\n"
        + "&contact set = 'upper.bottom'  against = 'lower.top'  friction = 0.5 /\n",
        "bar": one + material + sides.format("") + bar.format("") + "&contact set = 'bottom'  friction = 1.0 /\n",
        "bar_block": f"&mesh name = 'bar'  size = 40.0, 40.0  cells = {n}, {half} /\n"
        f"&mesh name = 'block'  size = 60.0, 20.0  cells = {n - 3}, {half}  origin = -20.0, -20.0 /\n" + material
        + sides.format("bar.") + sides.format("block.") + bar.format("bar.")
        + "&support set = 'block.bottom'  ux = 0.0  uy = 0.0 /\n"
        + "&contact set = 'bar.bottom'  against = 'block.top'  friction = 1.0 /\n"}
    for name, text in texts.items():
        (folder / f"{name}.nml").write_text(text)
    return {name: folder / f"{name}.nml" for name in texts}


def print_pairs(program, work, sizes, n_trials=5):
    """What a pair of bodies costs, beside one body of as many unknowns: the quickest of runs by turns."""
    rows = []
    for n in sizes:
        decks = pair_decks(work / f"pairs_{n}", n)
        output = work / f"pairs_{n}"
        phases = {name: [] for name in decks}
        totals = {name: [] for name in decks}
        for _ in range(n_trials):
            for name, deck in decks.items():
                used = run([program, "--quiet", "--threads", "1", "--output", output, deck], threads=1)[1]
                seconds_of = json.loads((output / f"{name}.summary.json").read_text())["seconds"]
                phases[name].append(sum(seconds_of[phase] for phase in ("assemble", "factorize", "condense")))
                totals[name].append(used["cpu"])
        made = {name: min(values) for name, values in phases.items()}
        total = {name: min(values) for name, values in totals.items()}
        rows.append([str(n), seconds(made["joined"]), f"{made['bonded'] / made['joined']:.2f}",
                     f"{made['contact'] / made['joined']:.2f}", seconds(total["bar"]),
                     f"{total['bar_block'] / total['bar']:.2f}"])
    table("Two bodies of n x n cells in all, one thread: assembling, factorizing and condensing two blocks, and the whole "
          "command for the long bar", ["n", "one mesh on a floor s", "two bonded, on a floor, times",
          "two in contact, times", "long bar s", "on a block, times"], rows)


def beside_decks(folder, is_full):
    """Decks by twos: one way of contact, and the plainest one of the same mesh and loads. And the phase that the first one
    makes longer."""
    folder.mkdir(parents=True, exist_ok=True)
    n, side, points = (800, 300, 4000) if is_full else (200, 100, 1000)
    strip = (f"&mesh size = 40.0, 10.0  cells = {n}, {n // 20}  element = 'quad8' /\n"
             "&material young = 13000.0  poisson = 0.3 /\n&support set = 'right'  ux = 0.0 /\n"
             "&load set = 'top'  traction = 0.0, -5.0 /\n&load set = 'left'  traction = 10.0, 0.0 /\n"
             "&contact set = 'bottom'  friction = 0.4{0} /\n")
    square = (f"&mesh size = 40.0, 40.0  cells = {side}, {side} /\n&material young = 13000.0  poisson = 0.2 /\n"
              "&support set = 'right'  ux = 0.0 /\n&load set = 'top'  traction = 0.0, -5.0 /\n"
              "&contact set = 'bottom'  friction = 0.3{0} /\n")
    # Waves that are lower than what the body moves.
    (folder / "profile.csv").write_text("".join(
        f"{x}, {-1e-4 * (1.0 - math.cos(3.0 * x))}\n" for x in (-60.0 + 160.0 * k / (points - 1) for k in range(points))))
    pair = ("&mesh name = 'upper'  size = 40.0, 20.0  cells = {1}, {2}  origin = 0.0, 20.0 /\n"
            "&mesh name = 'lower'  size = {0}, 20.0  cells = {1}, {2} /\n&material young = 13000.0  poisson = 0.2 /\n"
            "&support set = 'upper.right'  ux = 0.0 /\n&support set = 'lower.bottom'  ux = 0.0  uy = 0.0 /\n"
            "&load set = 'upper.top'  traction = 0.0, -5.0 /\n"
            "&contact set = 'upper.bottom'  against = 'lower.top'  friction = 0.5 /\n")
    texts = {
        f"{n} cells of constant multipliers, beside nodal ones": (
            "condense", strip.format(f"  multipliers = 'constant'  cells = {n}"), strip.format("")),
        f"a profile of {points} points, beside a plane": (
            "recover", square.format("  obstacle = 'polyline'  line = 'profile.csv'"), square.format("")),
        "a master that ends within its slave, beside one that does not": (
            "read", pair.format(30.0, side, side // 2), pair.format(40.0, side, side // 2))}
    decks = {}
    for k, (name, (phase, *pair_of_texts)) in enumerate(texts.items()):
        decks[name] = (phase, [folder / f"{which}_{k}.nml" for which in ("special", "plain")])
        for deck, text in zip(decks[name][1], pair_of_texts):
            deck.write_text(text)
    return decks


def print_beside(program, work, is_full, n_trials=3):
    """What ways of contact cost beside the plainest one: the quickest of runs by turns."""
    rows = []
    for name, (phase, decks) in beside_decks(work / "beside", is_full).items():
        phases, totals = ([], []), ([], [])
        for _ in range(n_trials):
            for k, deck in enumerate(decks):
                totals[k].append(run([program, "--quiet", "--output", work / "beside", deck], threads=1)[1]["cpu"])
                summary = json.loads((work / "beside" / f"{deck.stem}.summary.json").read_text())
                phases[k].append(summary["seconds"][phase])
        special, plain = (min(values) for values in totals)
        rows.append([name, phase, seconds(min(phases[1])), f"{min(phases[0]) / min(phases[1]):.1f}", seconds(plain),
                     f"{special / plain:.2f}"])
    table("Ways of contact beside the plainest one on the same mesh, one thread",
          ["what", "phase", "plain s", "times", "plain, whole command s", "times"], rows)


def print_peers(program, work, sizes):
    """One case, whole commands, each with one thread, and the friction of the floor that each finds."""
    peers = {"GetFEM": ("python3-getfem", "getfem_bar.py"), "CalculiX": ("calculix-ccx", "calculix_bar.py")}
    present = {name: script for name, (package, script) in peers.items() if version_of(package)}
    rows = []
    for n in sizes:
        deck = long_bar_decks(work / f"bar_{n}", (n, n))[0]
        ours = best_of(3, [program, "--quiet", "--threads", "1", "--output", work / f"bar_{n}", deck])["cpu"]
        found = json.loads((work / f"bar_{n}" / "long_bar_1.summary.json").read_text())["resultants"]
        row = [str(n), seconds(ours), f"{found['tangential_force']:.6f}"]
        for name in peers:
            if name in present:
                output, used = run([PYTHON, BENCH / present[name], n], threads=1)
                row += [seconds(used["cpu"]), f"{used['cpu'] / ours:.0f}", re.search(r"friction (\S+)", output)[1]]
            else:
                row += ["not installed", "-", "-"]
        rows.append(row)
    header = ["n", "Amontons s", "friction"] + [word for name in peers for word in (f"{name} s", "times", "friction")]
    table("Row 1 on n x n cells, processor time of the whole command on one thread, and friction of the floor", header,
          rows)


def cube_deck(folder, n, element="hex8", further=""):
    """A cube of n x n x n cells on a rough floor, its top moved down and aslant."""
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / f"cube_{element}_{n}{'_sweep' * bool(further)}.nml"
    top = ("&support set = 'top'  ux = 0.02  uy = 0.005  uz = -0.05 /" if not further else
           "&support set = 'top'  uz = -0.05 /\n&load name = 'push'  set = 'top'  traction = 0.004, 0.001, 0.0 /")
    deck.write_text(f"&mesh kind = 'box'  size = 1.0, 1.0, 1.0  cells = {n}, {n}, {n}  element = '{element}' /\n"
                    f"&material young = 1.0  poisson = 0.3 /\n{top}\n&contact set = 'bottom'  friction = 0.3 /\n{further}")
    return deck


def cubes_deck(folder, n):
    """Such a cube on one of a cell less along each edge, which is held below."""
    deck = folder / f"cubes_{n}.nml"
    deck.write_text(
        f"&mesh name = 'low'  kind = 'box'  size = 1.0, 1.0, 1.0  cells = {n - 1}, {n - 1}, {n - 1}  origin = 0.0, 0.0, -1.0 /\n"
        f"&mesh name = 'high'  kind = 'box'  size = 1.0, 1.0, 1.0  cells = {n}, {n}, {n} /\n"
        "&material young = 1.0  poisson = 0.3 /\n&support set = 'low.bottom'  ux = 0.0  uy = 0.0  uz = 0.0 /\n"
        "&support set = 'high.top'  ux = 0.03  uy = 0.0075  uz = -0.02 /\n"
        "&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /\n")
    return deck


def phases(program, folder, deck):
    """Runs a case; the processor time of the whole command, and its seconds of factorizing and condensing."""
    used = run([program, "--quiet", "--threads", "1", "--output", folder, deck], threads=1)[1]["cpu"]
    taken = json.loads((folder / f"{deck.stem}.summary.json").read_text())["seconds"]
    return used, taken["factorize"] + taken["condense"]


def deviations(output, key):
    """How far normal force and friction of another program are from those of the key results."""
    forces = map(float, re.search(r"normal (\S+) friction (\S+)", output).groups())
    return [f"{100 * (force / known - 1):+.4f} %"
            for force, known in zip(forces, (key["contact_force_z"], -key["contact_force_x"]))]


def print_cubes(program, work, sizes, has_pair=False):
    """A cube of solids, or two, with all files, beside CalculiX, by turns: the quickest of three runs."""
    rows, folder = [], work / "cubes"
    for n in sizes:
        deck = cube_deck(folder, n)
        apart = [deck, cube_deck(folder, n - 1)] if has_pair else []
        deck = cubes_deck(folder, n) if has_pair else deck
        ours, theirs, shares, output = [], [], [], ""
        for _ in range(3):
            used, condensed = phases(program, folder, deck)
            ours.append(used)
            if has_pair:
                shares.append(condensed / sum(phases(program, folder, one)[1] for one in apart))
            if version_of("calculix-ccx"):
                output, used = run([PYTHON, BENCH / "calculix_cube.py", n, *([n - 1] if has_pair else [])], threads=1)
                theirs.append(used["cpu"])
        result = json.loads((folder / f"{deck.stem}.summary.json").read_text())
        key = result["key_results"]
        row = [str(n), str(result["counts"]["dofs"]), str(result["iterations"]), seconds(min(ours)),
               f"{key['contact_force_z']:.6g}", f"{-key['contact_force_x']:.6g}"]
        if theirs:
            row += [seconds(min(theirs)), f"{min(theirs) / min(ours):.0f}", *deviations(output, key)]
        else:
            row += ["not installed", "-", "-", "-"]
        rows.append(row + [f"{min(shares):.2f}" for _ in shares[:1]])
    table(f"A cube of n x n x n hexahedra on {'one of n - 1 cells' if has_pair else 'a rough floor'}, processor time of the "
          "whole command on one thread" + "; factorizing and condensing, over that of both apart" * has_pair,
          ["n", "unknowns", "steps", "s", "normal force", "friction", "CalculiX s", "times", "its normal force",
           "its friction"] + ["apart, times"] * has_pair, rows)


def print_cube_peers(program, work, sizes):
    """The cube in programs that take it from Python."""
    rows = []
    for n in sizes:
        deck = cube_deck(work / "cubes", n)
        ours = min(phases(program, work / "cubes", deck)[0] for _ in range(3))
        key = json.loads((work / "cubes" / f"{deck.stem}.summary.json").read_text())["key_results"]
        for name, python, script in (("GetFEM", version_of("python3-getfem") and PYTHON, "getfem_cube.py"),
                                     ("felupe", FELUPE if FELUPE.exists() else None, "felupe_cube.py")):
            row = [str(n), name, "not installed", "-", "-", "-"]
            if python:
                output, used = run([python, BENCH / script, n], threads=1)
                row[2:] = [seconds(used["cpu"]), f"{used['cpu'] / ours:.0f}", *deviations(output, key)]
            rows.append(row)
    table("The cube on a rough floor in GetFEM and felupe, processor time on one thread over that of the whole command",
          ["n", "program", "s", "times", "its normal force", "its friction"], rows)


def print_solids(program, work, sizes, n_cases):
    """What the rest costs beside the factorization, and the memory that `--check` announces; further cases on one S."""
    rows = []
    for element, n in sizes:
        deck = cube_deck(work / "cubes", n, element)
        said = float(re.search(r"about (\S+) MB", run([program, "--check", "--threads", "1", deck])[0])[1])
        used = best_of(3, [program, "--quiet", "--threads", "1", "--output", work / "cubes", deck], threads=1)
        result = json.loads((work / "cubes" / f"{deck.stem}.summary.json").read_text())
        spent = result["seconds"]["factorize"]
        sweep = cube_deck(work / "cubes", n, element, f"&sweep load = 'push'  factor = 0.0, 1.0  count = {n_cases} /\n")
        times = [run([program, "--quiet", "--threads", "1", "--output", work / "cubes", deck_of], threads=1)[1]["cpu"]
                 for deck_of in (sweep, cube_deck(work / "cubes", n, element, "&sweep load = 'push'  factor = 1.0 /\n"))]
        rows.append([f"{n}, {element}", str(result["counts"]["dofs"]), str(result["counts"]["contact_points"]),
                     seconds(spent), f"{1e-9 * result['factor']['flops'] / spent:.1f}", seconds(used["cpu"]),
                     f"{used['cpu'] / spent:.1f}", f"{used['mb']:.0f}", f"{used['mb'] / said:.2f}",
                     seconds((times[0] - times[1]) / (n_cases - 1))])
    table("Cubes of solids, one thread: the factorization, the whole command over it, memory over what `--check` says, and "
          "a further case on the same matrix of the contact points",
          ["cube", "unknowns", "contact points", "factorize s", "Gflop/s", "whole command s", "times", "memory MB",
           "of what was said", "a further case s"], rows)


def part_deck(folder, name, scale):
    """A part of input/ on a finer mesh, by Gmsh."""
    folder.mkdir(parents=True, exist_ok=True)
    geometry = (ROOT / "input" / f"{name}.geo").read_text()
    geometry = re.sub(r"((?m:^h|MeshSizeM\w\w|MeshSize \{.*\}) = )(?=\d)", rf"\g<1>{scale}*", geometry)
    geometry = re.sub(r'(Field\[1\]\.F = ")(.*)"', rf'\g<1>{scale}*(\g<2>)"', geometry)
    (folder / f"{name}.geo").write_text(geometry)
    run(["gmsh", "-3", "-format", "msh41", folder / f"{name}.geo", "-o", folder / f"{name}.msh"])
    return (ROOT / "input" / f"{name}.nml").read_text()


def print_parts(program, work, parts):
    """Parts of unstructured tet10: the factorization beside CHOLMOD's, the whole command over it, and memory."""
    rows, folder = [], work / "parts"
    for name, scale in parts if shutil.which("gmsh") else ():
        text = part_deck(folder, name, scale)
        found = {}
        for kind in ("multifrontal", "sparse"):
            deck = folder / f"{name}_{kind}.nml"
            deck.write_text(text + f"\n&solver factorization = '{kind}' /\n")
            said = float(re.search(r"about (\S+) MB", run([program, "--check", "--threads", "1", deck])[0])[1])
            used = run([program, "--quiet", "--threads", "1", "--output", folder, deck], threads=1)[1]
            result = json.loads((folder / f"{name}_{kind}.summary.json").read_text())
            found[kind] = (result, result["seconds"]["factorize"], used, said)
        (result, spent, used, said), (other, theirs, *_) = found.values()
        rows.append([name, str(result["counts"]["dofs"]), str(result["counts"]["contact_points"]),
                     f"{1e-9 * result['factor']['flops']:.0f}", f"{1e-9 * other['factor']['flops']:.0f}", seconds(spent),
                     seconds(theirs), f"{spent / theirs:.2f}", f"{used['cpu'] / spent:.1f}", f"{used['mb']:.0f}",
                     f"{used['mb'] / said:.2f}"])
    table("Parts of unstructured tet10 by Gmsh, one thread: the factorization beside CHOLMOD's, the whole command over it, "
          "and its memory over what `--check` says",
          ["part", "unknowns", "contact points", "Gflop", "CHOLMOD Gflop", "factorize s", "CHOLMOD s", "times",
           "whole command, times", "memory MB", "of what was said"], rows)


def print_reduced(program, work, sizes, rates):
    """Reduced problems of the bar: `auto`, one sweep of `psor`, and Siconos."""
    rows = []
    for n in sizes:
        folder = work / f"reduced_{n}"
        deck = long_bar_decks(folder, (n, n))[0]
        # Pinned, as code_aster's test is: a reduced problem needs a held body.
        deck.write_text(deck.read_text() + "\n&support point = 40.0, 0.0  uy = 0.0 /\n")
        run([program, "--quiet", "--write-reduced", "--output", folder, deck])
        problem = folder / "long_bar_1.reduced.dat"
        solved = folder / "solved"
        run([program, "--quiet", "--threads", "1", "--output", solved, "--reduced", problem])
        summary = json.loads(next(solved.glob("*.summary.json")).read_text())
        ours = summary["seconds"]["solve"]
        peers = {}
        if version_of("python3-siconos"):
            output = run([PYTHON, BENCH / "siconos_reduced.py", problem, 20], threads=1, check=False)[0]
            peers = dict(line.split(": ", 1) for line in output.splitlines() if ": " in line)
        rows.append([str(n + 1), seconds(ours), f"{summary['residual']:.0e}"]
                    + [peers.get(name, "not installed") for name in ("Newton", "Lemke", "Gauss-Seidel")])
    table("Reduced problems of m contact points (row 1, corner pinned), one thread: time of the method and residual",
          ["m", "auto s", "residual", "Siconos Newton", "Siconos Lemke", "Siconos Gauss-Seidel"], rows)


def history_decks(folder, cells, counts):
    """The long bar's history from rest through F = 10, 15, 5, -15, 10 in so many steps, by their number."""
    folder.mkdir(parents=True, exist_ok=True)
    bar = re.sub(r"&load.*/\n", "", long_bar_decks(folder, cells)[0].read_text())
    loads = """&load name = 'F'  set = 'left'  traction = 1.0, 0.0 /
&load name = 'f'  set = 'top'  traction = 0.0, -5.0 /
"""
    decks = {}
    for count in counts:
        deck = folder / f"history_{count}.nml"
        legs = "" if count == 1 else f", 1.0, 2.0, 3.0, 4.0, 5.0  substeps = {count // 5}"
        forces, pressures = ("10.0", "1.0") if count == 1 else ("0.0, 10.0, 15.0, 5.0, -15.0, 10.0",
                                                                "0.0, 1.0, 1.0, 1.0, 1.0, 1.0")
        deck.write_text(re.sub(r"long_bar_\d", f"history_{count}", bar) + loads + f"""&history times = 0.0{legs} /
&steps load = 'F'  factor = {forces} /
&steps load = 'f'  factor = {pressures} /
""")
        decks[count] = deck
    return decks


def print_histories(program, work, counts):
    """What a step costs, files included: the whole command less that of a history of one step."""
    rows = []
    for cells in ((32, 10), (128, 128)):
        folder = work / f"history_{cells[0]}"
        decks = history_decks(folder, cells, (1, *counts))
        used = {count: min(run([program, "--quiet", "--threads", "1", "--output", folder, deck])[1]["cpu"]
                           for _ in range(5 if count <= 1000 else 2)) for count, deck in decks.items()}
        points = json.loads((folder / "history_1.summary.json").read_text())["counts"]["contact_points"]
        for count in counts:
            made = json.loads((folder / f"history_{count}.summary.json").read_text())["load_history"]
            steps = used[count] - used[1]
            rows.append([f"{cells[0]} x {cells[1]}", str(points), str(made["steps"]),
                         f"{made['iterations'] / made['steps']:.1f}", seconds(used[count]),
                         f"{made['steps'] / steps:.0f}", f"{1e6 * steps / made['steps']:.0f}"])
    table("Load histories of the long bar: processor time on one thread, files included",
          ["cells", "contact points", "steps", "iterations per step", "whole command s", "steps per second",
           "microseconds per step"], rows)


def print_steps_beside_cases(program, work, count):
    """As many steps, cases of a sweep and static decks of one run, each with loads of its own."""
    rows = []
    for cells in ((32, 10), (128, 128)):
        folder = work / f"history_{cells[0]}"
        step = history_decks(folder, cells, (count,))[count]
        bar = long_bar_decks(folder, cells)[0].read_text()
        forces = [15.0 * math.sin(0.1 * k) for k in range(count)]
        sweep = folder / "sweep.nml"
        named = re.sub(r"long_bar_\d", "sweep", bar).replace("&load set = 'left'", "&load name = 'F'  set = 'left'")
        sweep.write_text(named + f"&sweep load = 'F'  factor = {', '.join(f'{force / 10.0!r}' for force in forces)} /\n")
        decks = []
        for k, force in enumerate(forces):
            decks.append(folder / f"static_{k}.nml")
            decks[-1].write_text(re.sub(r"long_bar_\d", f"static_{k}", bar).replace("10.0, 0.0", f"{force!r}, 0.0"))
        for what, list_of_decks in (("steps", [step]), ("sweep", [sweep]), ("decks", decks)):
            used = run([program, "--quiet", "--threads", "1", "--output", folder, *list_of_decks])[1]
            rows.append([f"{cells[0]} x {cells[1]}", {"steps": f"a history of {count + 1} steps", "sweep":
                         f"a sweep of {count} cases", "decks": f"{count} decks in one run"}[what],
                         seconds(used["cpu"]), seconds(1e3 * used["cpu"] / count)])
    table("Steps beside static cases, whole commands on one thread, all files included",
          ["cells", "what", "processor time s", "ms each"], rows)


def main(build, work, is_full):
    program = build / "bin/amontons"
    rates = print_machine(build)
    tables = (
        ("the long bar", print_long_bar, (32, 64, 128, 256, 512, 1024) if is_full else (32, 64, 128, 256), rates),
        ("strips", print_strips, (1000, 2000, 4000, 10000) if is_full else (1000, 2000)),
        ("pairs", print_pairs, (128, 256, 512) if is_full else (128,)),
        ("ways of contact", print_beside, is_full),
        ("other programs", print_peers, (64, 128, 256) if is_full else (32, 64)),
        ("cubes", print_cubes, (8, 16, 24) if is_full else (8, 16)),
        ("the cube in Python", print_cube_peers, (8, 16) if is_full else (8,)),
        ("cubes on cubes", print_cubes, (8, 16, 25) if is_full else (8, 16), True),
        ("solids", print_solids, (("hex8", 16), ("hex8", 24), ("tet10", 8), ("hex20", 8)) + (("tet10", 16),) * is_full,
         51 if is_full else 11),
        ("parts", print_parts, (("bracket_feet", 0.26), ("ball", 0.335), ("blade_root_solid", 0.23)) if is_full else
         (("bracket_feet", 0.5),)),
        ("reduced problems", print_reduced, (128, 256, 512, 1024) if is_full else (128, 256), rates),
        ("histories", print_histories, (100, 1000, 10000)),
        ("steps beside cases", print_steps_beside_cases, 200 if is_full else 20),
    )
    for i, (name, print_table, *arguments) in enumerate(tables, start=1):
        print(f"[{i}/{len(tables)}] {name}", file=sys.stderr, flush=True)
        print_table(program, work, *arguments)


main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), "--full" in sys.argv[3:])
