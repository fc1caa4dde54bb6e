"""Compares methods on reduced problems in space, those of Amontons and of Siconos, in one measure; draws a profile.

Usage: space_methods.py PROGRAM [--solvers all|amontons] [--figure FILE] [FILE...]
       space_methods.py PROGRAM --bodies

Solves the reduced problems in FILEs (Siconos' text), and piles of rigid bodies made by random numbers. A solution
is judged by its forces alone: u = W r + q is computed from them, and the residual is that of doc/theory.md,
section 7. Times are of the processor, one thread, the least of a few runs: of the call of a solver in arrays or,
of large W, of the program with its files. Siconos' solvers have the options that they come with, but for tolerance
and iterations. One that takes more than LIMIT seconds is stopped. With --bodies it compares Amontons' methods on
twisted bodies of BODIES, in the time that the program takes to solve the contact problem. Needs NumPy, h5py,
python3-siconos and, for the figure, Matplotlib, and the shared library of Amontons in AMONTONS_LIBRARY.
"""
from __future__ import annotations

import argparse
import json
import os
import pickle
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
import amontons  # noqa: E402  pylint: disable=wrong-import-position
from amontons import fclib  # noqa: E402  pylint: disable=wrong-import-position

LIMIT = 3           # seconds of the processor for one solution
ITERATIONS = 100000
N_PILES = 24
DENSE_ROWS = 600    # W of more rows may be sparse in the program
METHODS = ("auto", "newton", "splitting", "fixed_point", "psor", "extragradient")
SOLVERS = ("NSGS", "NSN_AC", "NSN_FB", "PROX", "TFP", "ACLMFP", "DSFP", "VI_EG", "ADMM")
GOALS = (1e-8, 1e-10)
MATERIAL = "&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true. /\n"
CYLINDER = MATERIAL + ("&mesh size = 1.0, 1.0  cells = {0}, {0} /\n&support set = 'left'  ux = 0.0 /\n"
                       "&support set = 'top'  turn = {1} /\n&load set = 'top'  pressure = 1.0 /\n"
                       "&contact set = 'bottom'  friction = {2}  ")
RINGS = MATERIAL + ("&mesh name = 'a'  size = {0}  cells = {{0}}, {{0}}  origin = {1} /\n"
                    "&mesh name = 'b'  size = {2}  cells = {3}, {3}  origin = {4} /\n")
# Of each body a deck, with places for cells, turn and friction, and the turn for a friction of 1.
BODIES = {
    "press fit, pulled and twisted": (
        RINGS.format("1.0, 1.0", "0.0, 0.0", "1.0, 1.0", "{3}", "1.0, 0.0") +
        "&support set = 'a.left'  ux = 0.0 /\n&support set = 'a.bottom'  uy = 0.0  turn = 0.0 /\n"
        "&support set = 'b.top'  uy = {1}  turn = {1} /\n&contact set = 'b.left'  against = 'a.right'  "
        "gap = 'touching'  extra_gap = -0.002  friction = {2} /\n", 1.5e-3),
    "clutch": (
        RINGS.format("1.0, 0.5", "1.0, 0.0", "1.0, 0.5", "{3}", "1.0, 0.5") +
        "&support set = 'a.bottom'  uy = 0.0  turn = 0.0 /\n&support set = 'b.top'  turn = {1} /\n"
        "&load set = 'b.top'  pressure = 1.0 /\n&contact set = 'b.bottom'  against = 'a.top'  friction = {2} /\n",
        1.5e-3),
    "flat end of a cylinder": (CYLINDER + "/\n", 1.5e-3),
    "round end of a cylinder": (CYLINDER + "obstacle = 'circle'  radius = 100.0 /\n", 2e-3)}


def pile(seed):
    """The reduced problem of a pile of rigid bodies: more contacts than their motions can tell apart, W singular."""
    numbers = np.random.default_rng(seed)
    n_bodies = int(numbers.integers(3, 30))
    m = int(n_bodies*numbers.uniform(1, 5))
    h = np.zeros((3*m, 6*n_bodies))
    for k in range(m):
        one, other = numbers.permutation(n_bodies + 1)[:2]  # body n_bodies is the ground
        axes = np.linalg.qr(numbers.normal(size=(3, 3)))[0]
        for body, sign in ((one, 1), (other, -1)):
            if body < n_bodies:
                arm = numbers.normal(0, 2, 3)
                cross = np.array([[0, arm[2], -arm[1]], [-arm[2], 0, arm[0]], [arm[1], -arm[0], 0]])
                h[3*k:3*k + 3, 6*body:6*body + 3] += sign*axes.T
                h[3*k:3*k + 3, 6*body + 3:6*body + 6] += sign*axes.T @ cross
    mass = np.repeat(np.exp(numbers.normal(0, 1, n_bodies)), 6)
    velocity = numbers.normal(0, 0.3, 6*n_bodies)
    velocity[2::6] -= 1
    w = (h/mass) @ h.T
    row, column = np.nonzero(w)
    return fclib.Problem(row, column, w[row, column], h @ velocity, numbers.uniform(0.2, 1.2, m), dimension=3)


def full(problem):
    """W as a full matrix."""
    w = np.zeros((len(problem.q), len(problem.q)))
    np.add.at(w, (problem.row, problem.column), problem.value)
    return w


def residual(problem, w, r):
    """The residual of forces r: largest violation of the law as a force and as a displacement."""
    q, mu = problem.q, problem.mu
    if r is None or not np.isfinite(r).all():
        return np.inf
    u = (w @ r + q).reshape(-1, 3)
    r = r.reshape(-1, 3)
    blocks = np.array([w[3*k + 1:3*k + 3, 3*k + 1:3*k + 3] for k in range(len(mu))])
    own = np.array([np.diag(w)[::3], np.linalg.eigvalsh((blocks + blocks.transpose(0, 2, 1))/2)[:, -1]])
    own = np.where(own > 0, own, own.max())
    load = np.array([np.abs(q[::3]), np.hypot(q[1::3], q[2::3])])
    scale = (load/own).max()
    weight = np.maximum(1, scale*own.max(axis=0)/load.max())
    normal = np.abs(np.minimum(r[:, 0], u[:, 0]/own[0]))
    trial = r[:, 1:] - u[:, 1:]/own[1][:, None]
    length, bound = np.hypot(*trial.T), mu*np.maximum(0, r[:, 0])
    share = np.where(length > bound, bound/np.maximum(length, 1e-300), 1)
    return float((weight*np.maximum(normal, np.hypot(*(r[:, 1:] - share[:, None]*trial).T))).max()/scale)


def in_a_child(call, who=resource.RUSAGE_SELF):
    """What a call returns with the processor time that it takes, its own or that of the programs it runs, or None where
    it fails or takes too long."""
    def seconds():
        usage = resource.getrusage(who)
        return usage.ru_utime + usage.ru_stime

    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        status = 1
        try:
            least = np.inf
            for _ in range(3):
                start = seconds()
                result = call()
                least = min(least, seconds() - start)
                if least > 0.1:
                    break
            with os.fdopen(writer, "wb") as pipe:
                pickle.dump((result, least), pipe)
            status = 0
        finally:
            os._exit(status)
    os.close(writer)
    with os.fdopen(reader, "rb") as pipe:
        content = pipe.read()
    os.waitpid(child, 0)
    return pickle.loads(content) if content else None


def solve_here(problem, w, method, tolerance):
    """Forces and iterations of one of Amontons' methods, in arrays."""
    def call():
        result = amontons.solve_reduced(w, problem.q, problem.mu, method=method, tolerance=tolerance,
                                        max_iterations=ITERATIONS, dimension=3)
        return result.r, result.iterations

    return in_a_child(call)


def solve_by_program(program, path, method, tolerance):
    """The same by the program, with its files."""
    def call():
        with tempfile.TemporaryDirectory() as folder:
            deck = Path(folder) / "case.nml"
            deck.write_text(f"&problem kind = 'reduced'  file = '{path}' /\n&solver method = '{method}'  "
                            f"tolerance = {tolerance}  max_iterations = {ITERATIONS} /\n", encoding="utf-8")
            subprocess.run([program, "--quiet", "--output", folder, deck], check=False, capture_output=True)
            problem = fclib.read_solution(Path(folder) / "case.contact.csv", fclib.read_text(path))
            summary = json.loads((Path(folder) / "case.summary.json").read_text(encoding="utf-8"))
            return problem.r, summary["iterations"]

    return in_a_child(call, resource.RUSAGE_CHILDREN)


def solve_by_siconos(problem, w, solver, tolerance):
    """Forces of one of Siconos' solvers, and no iterations."""
    import siconos.numerics as numerics  # pylint: disable=import-outside-toplevel

    def call():
        case = numerics.FrictionContactProblem(3, len(problem.mu), np.asfortranarray(w), problem.q.copy(),
                                               problem.mu.copy())
        options = numerics.SolverOptions(getattr(numerics, f"SICONOS_FRICTION_3D_{solver}"))
        options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = ITERATIONS
        options.dparam[numerics.SICONOS_DPARAM_TOL] = tolerance
        r, u = np.zeros(len(problem.q)), np.zeros(len(problem.q))
        numerics.fc3d_driver(case, r, u, options)
        return r, int(options.iparam[numerics.SICONOS_IPARAM_ITER_DONE])

    return in_a_child(call)


def solve_to(goal, solve, measure):
    """The least time in which a solver comes to a goal, with tolerances of its own that get smaller; else infinity."""
    for share in (1, 1e-3):
        found = solve(goal*share)
        if found is None:
            return np.inf, None
        (r, iterations), seconds = found
        if measure(r) <= goal:
            return seconds, iterations
    return np.inf, None


def compare(program, problems, solvers):
    """Seconds and iterations of every solver for every problem and goal (inf where it does not come there)."""
    table = {}
    for name, (problem, path) in problems.items():
        w = full(problem)
        for solver in solvers:
            if solver in METHODS and len(problem.q) > DENSE_ROWS:
                solve = lambda tolerance, s=solver: solve_by_program(program, path, s, tolerance)
            elif solver in METHODS:
                solve = lambda tolerance, s=solver: solve_here(problem, w, s, tolerance)
            else:
                solve = lambda tolerance, s=solver: solve_by_siconos(problem, w, s, tolerance)
            for goal in GOALS:
                seconds, iterations = solve_to(goal, solve, lambda r: residual(problem, w, r))
                table[solver, name, goal] = seconds, iterations
                if not np.isfinite(seconds) and goal == GOALS[0]:
                    table[solver, name, GOALS[1]] = seconds, iterations
                    break
            print(name, len(problem.mu), solver, *(table[solver, name, goal] for goal in GOALS), file=sys.stderr,
                  flush=True)
    return table


def total(values):
    """Their sum, to two digits."""
    if not np.isfinite(values).all():
        return "not all"
    return f"{float(f'{sum(values):.1e}'):.4g}" if values else "–"


def print_tables(table, names, solvers):
    """The tables of doc/methods.md."""
    common = [name for name in names if all(np.isfinite(table[s, name, 1e-8][0]) for s in METHODS if s in solvers)]
    print("| method | solved to 1e-8 | to 1e-10 | iterations to 1e-10, median | most | s to 1e-10, all it solves | "
          f"s to 1e-8, {len(common)} problems that each of Amontons' methods solves |\n|---|---|---|---|---|---|---|")
    for solver in solvers:
        solved = [sum(np.isfinite(table[solver, name, goal][0]) for name in names) for goal in GOALS]
        found = [table[solver, name, GOALS[1]] for name in names if np.isfinite(table[solver, name, GOALS[1]][0])]
        iterations = [k for _, k in found] if solver in METHODS and found else None
        label = f"`{solver}`" if solver in METHODS else f"Siconos {solver}"
        print(f"| {label} | {solved[0]} | {solved[1]} | "
              f"{f'{int(np.median(iterations))} | {max(iterations)}' if iterations else '– | –'} | "
              f"{total([s for s, _ in found])} | {total([table[solver, name, 1e-8][0] for name in common])} |")


def draw(table, names, solvers, path):
    """A performance profile: the share of the problems that a solver solves within so many times the least time."""
    import matplotlib  # pylint: disable=import-outside-toplevel
    matplotlib.use("Agg")
    from matplotlib import pyplot  # pylint: disable=import-outside-toplevel
    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4.2), sharey=True)
    styles = ["-", "--", "-.", ":"]
    for panel, goal in zip(axes, GOALS):
        seconds = np.array([[max(table[solver, name, goal][0], 1e-4) for name in names] for solver in solvers])
        ratio = seconds/np.where(np.isfinite(seconds), seconds, np.inf).min(axis=0)
        for k, solver in enumerate(solvers):
            steps = np.sort(ratio[k][np.isfinite(ratio[k])])
            is_own = solver in METHODS
            panel.step([*steps, 1e4], [*((np.arange(len(steps)) + 1)/len(names)), len(steps)/len(names)], where="post",
                       linestyle=styles[k % 4], linewidth=1 + is_own,
                       color=f"C{k}" if is_own else pyplot.cm.Greys(0.4 + 0.06*(k - len(METHODS))),
                       label=solver if is_own else f"Siconos {solver}")
        panel.set(xscale="log", xlim=(1, 1e4), ylim=(0, 1.02), xlabel="time over the least of all solvers",
                  title=f"residual {goal:.0e}".replace("e-0", "e-"))
        panel.grid(alpha=0.3)
    axes[0].set_ylabel("share of the problems solved")
    axes[1].legend(loc="center left", bbox_to_anchor=(1.02, 0.5), fontsize=8, frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=130)


def compare_on_bodies(program):
    """The table of doc/methods.md on twisted bodies: for each friction the iterations, and the sum of the times."""
    methods = METHODS[1:-1]
    print(f"| body | points | {' | '.join(f'`{method}`' for method in methods)} |\n|---{'|---'*(1 + len(methods))}|")
    for name, (text, turn) in BODIES.items():
        for n in (16, 64):
            cells = []
            for method in methods:
                iterations, seconds = [], 0.0
                for friction in (0.1, 0.5, 1.0):
                    with tempfile.TemporaryDirectory() as folder:
                        deck = Path(folder) / "case.nml"
                        deck.write_text(text.format(n, turn*friction, friction, 3*n//2) + "&solver method = "
                                        f"'{method}'  max_iterations = 10000 /\n", encoding="utf-8")
                        least = np.inf
                        for _ in range(12):
                            subprocess.run([program, "--quiet", "--output", folder, deck], check=False,
                                           capture_output=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
                            summary = json.loads((Path(folder) / "case.summary.json").read_text(encoding="utf-8"))
                            least = min(least, summary["seconds"]["solve"])
                    iterations.append(str(summary["iterations"]) if summary["converged"] else "–")
                    seconds += least
                    print(name, n, friction, method, summary["counts"], iterations[-1], least, file=sys.stderr)
                cells.append(f"{', '.join(iterations)}; {float(f'{1e3*seconds:.1e}'):g} ms")
            print(f"| {name} | {summary['counts']['contact_points']} | {' | '.join(cells)} |", flush=True)


def main():
    """Compares."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--solvers", choices=("all", "amontons"), default="all")
    parser.add_argument("--figure")
    parser.add_argument("--bodies", action="store_true")
    parser.add_argument("files", nargs="*", type=Path)
    options = parser.parse_intermixed_args()
    if options.bodies:
        compare_on_bodies(options.program)
        return
    problems = {path.stem: (fclib.read_text(path), path.resolve()) for path in options.files}
    problems.update({f"pile {seed}": (pile(seed), None) for seed in range(N_PILES)})
    solvers = METHODS + (SOLVERS if options.solvers == "all" else ())
    table = compare(options.program, problems, solvers)
    print_tables(table, list(problems), solvers)
    if options.figure:
        draw(table, list(problems), solvers, options.figure)


if __name__ == "__main__":
    main()
