"""Compares the contact methods on the rows of Table 1 of Pop and Zelina (2005), and the condition of the matrices that
their splitting makes of the dual problem. Prints tables in Markdown.

Usage: compare_methods.py [--segments N,...] [--rows N,...] [--elements NAME,...] [--timings N] FOLDER [IMAGE...]
The environment variable AMONTONS names the program. FOLDER gets runs.csv, one line for each run; images are drawn of
the first element. The time of a short run is the least of N.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

from table1 import ROWS, scientific

SIDE = 40.0  # mm
MOST_ITERATIONS = 10000
LONG = 0.1  # s: a run that takes as long is timed once
METHODS = {  # label: what the deck's &solver says
    "auto": "method = 'auto'",
    "newton": "method = 'newton'",
    "splitting": "method = 'splitting'",
    "splitting, mprgp": "method = 'splitting'  box = 'mprgp'",
    "splitting, clip": "method = 'splitting'  variant = 'clip'",
    "splitting, printed": "method = 'splitting'  variant = 'printed'",
    "fixed_point": "method = 'fixed_point'",
    "fixed_point, mprgp": "method = 'fixed_point'  box = 'mprgp'",
    "psor dual": "method = 'psor'",
    "psor dual, block": "method = 'psor'  local = 'block'",
    "psor dual, anderson": "method = 'psor'  acceleration = 'anderson'",
    "psor primal": "method = 'psor'  space = 'primal'",
    "psor primal, 1.6": "method = 'psor'  space = 'primal'  omega = 1.6",
    "psor primal, 1.6, anderson": "method = 'psor'  space = 'primal'  omega = 1.6  acceleration = 'anderson'",
    "extragradient": "method = 'extragradient'",
    "lemke": "method = 'lemke'",
}
FINITE = ("auto", "newton", "lemke")  # they end in exact steps: their residuals tell no rate
BODIES = {"held by contact alone": "", "pinned at (40, 0)": "&support point = 40.0, 0.0  uy = 0.0 /"}
ALONE, PINNED = BODIES
INPUT = pathlib.Path(__file__).resolve().parents[2] / "input"


def deck(name, row, element, segments, body, solver):
    """The deck of a row of Table 1 in another form; its mesh keeps the proportion 32 x 10."""
    text = (INPUT / f"long_bar_{row}.nml").read_text(encoding="utf-8")
    replacements = (
        (r"&case name = '\w+'", f"&case name = '{name}'"),
        (r"cells = 32, 10", f"cells = {segments}, {segments * 10 // 32}"),
        (r"element = 'quad4'", f"element = '{element}'"),
        (r"&solver [^/]*/", f"{BODIES[body]}\n&solver {solver}  max_iterations = {MOST_ITERATIONS} /"),
    )
    for pattern, replacement in replacements:
        text, found = re.subn(pattern, replacement, text)
        assert found == 1, pattern
    return text


def solve(folder, *form, options=()):
    """Runs a deck; returns its summary and its contact forces, normal ones first."""
    path = folder / "run.nml"
    path.write_text(deck("run", *form), encoding="utf-8")
    run = subprocess.run([os.environ["AMONTONS"], "--quiet", "--threads", "1", *options, "--output", folder, path],
                         capture_output=True, text=True, check=False)
    if run.returncode not in (0, 4):  # 4: not converged, which the tables tell
        sys.exit(f"compare_methods.py: {form}: {run.stderr}")
    summary = json.loads((folder / "run.summary.json").read_text(encoding="utf-8"))
    with open(folder / "run.contact.csv", newline="", encoding="utf-8") as table:
        points = list(csv.DictReader(table))
    return summary, np.array([float(point[column]) for column in ("normal_force", "tangential_force")
                              for point in points])


def exact_forces(folder, *form):
    """The forces of the discrete problem, as exact as doubles allow."""
    summary, forces = solve(folder, *form, "method = 'auto'  tolerance = 1.0e-13")
    assert summary["converged"], form
    return forces


def contraction(history):
    """What an iteration multiplies the residual by, in the geometric mean over the second half of the iterations."""
    middle = len(history) // 2
    if middle < 4:
        return math.nan
    return (history[-1] / history[middle - 1]) ** (1.0 / (len(history) - middle))


def measure(folder, label, row, element, segments, body, exact, n_timings):
    """Runs a method on a row; returns the line of runs.csv, and the residual after each iteration."""
    summary, forces = solve(folder, row, element, segments, body, METHODS[label])
    seconds = [summary["seconds"]["solve"]]
    while len(seconds) < n_timings and seconds[0] < LONG:
        seconds.append(solve(folder, row, element, segments, body, METHODS[label])[0]["seconds"]["solve"])
    has_rate = summary["converged"] and label not in FINITE
    return {
        "element": element, "body": body, "method": label, "segments": segments, "row": row,
        "converged": summary["converged"], "iterations": summary["iterations"], "products": summary["products"],
        "factorizations": summary["factorizations"], "milliseconds": 1e3 * min(seconds),
        "residual": summary["residual"],
        "contraction": contraction(summary["residual_history"]) if has_rate else math.nan,
        "error": float(np.abs(forces - exact).max() / np.abs(exact).max()),
    }, summary["residual_history"]


def compliance(folder, element, segments):
    """The paper's A of the pinned bar, its normal forces first. Signs of components differ from the paper's in whole
    rows and columns, which no number below sees."""
    solve(folder, 1, element, segments, PINNED, "method = 'auto'", options=["--write-reduced"])
    words = (folder / "run.reduced.dat").read_text(encoding="utf-8").split()
    order = 2 * int(words[1])
    # dimension, contacts, storage, the order four times, then the entries
    matrix = np.array(words[7:7 + order * order], dtype=float).reshape(order, order)
    order = np.r_[0:order:2, 1:order:2]
    return matrix[np.ix_(order, order)]


def conditions(matrix):
    """Condition numbers of A, its blocks and both Schur complements, and how strongly the blocks are coupled."""
    m = len(matrix) // 2
    a11, a12, a21, a22 = matrix[:m, :m], matrix[:m, m:], matrix[m:, :m], matrix[m:, m:]
    coupling = np.linalg.solve(a11, a12) @ np.linalg.solve(a22, a21)
    return {
        "cond A": np.linalg.cond(matrix),
        "cond A11": np.linalg.cond(a11),
        "cond A22": np.linalg.cond(a22),
        "cond A11 - A12 A22⁻¹ A21": np.linalg.cond(a11 - a12 @ np.linalg.solve(a22, a21)),
        "cond A22 - A21 A11⁻¹ A12": np.linalg.cond(a22 - a21 @ np.linalg.solve(a11, a12)),
        "coupling, radius": np.abs(np.linalg.eigvals(coupling)).max(),
        "coupling, norm": np.linalg.norm(coupling, 2),
        "A11 to A22": np.trace(a11) / np.trace(a22),
    }


def two_digits(value):
    return f"{float(f'{value:.2g}'):g}"


def print_line(cells):
    print("| " + " | ".join(map(str, cells)) + " |")


def print_head(title, columns):
    print(f"\n### {title}\n")
    print_line(columns)
    print_line(["---"] * len(columns))


def print_conditions(found, elements, segments):
    print_head("Condition of A, pinned bar", ["element", "segments", "h, mm", *found[elements[0], segments[0]]])
    for element in elements:
        for n in segments:
            print_line([element, n, f"{SIDE / n:g}", *(scientific(value) for value in found[element, n].values())])
        if len(segments) > 1:
            first, last = (found[element, n] for n in (segments[0], segments[-1]))
            growth = (math.log(last[name] / first[name]) / math.log(segments[-1] / segments[0]) for name in first)
            print_line([element, "growth", "power of 1/h", *(f"{power:.2f}" for power in growth)])


def print_runs(runs, element, body, segments, rows):
    columns = ["method", "segments", *(f"row {row}" for row in rows), "products", "factorizations", "ms", "residual",
               "rate", "error"]
    print_head(f"{element}, {body}", columns)
    for label in METHODS:
        for n in segments:
            found = [runs[element, body, label, n, row] for row in rows]
            iterations = (str(run["iterations"]) if run["converged"] else f"({run['iterations']})" for run in found)
            largest = {name: max(run[name] for run in found)
                       for name in ("products", "factorizations", "residual", "error")}
            rates = [run["contraction"] for run in found if not math.isnan(run["contraction"])]
            print_line([label, n, *iterations, f"{largest['products']:.0f}", largest["factorizations"],
                        two_digits(sum(run["milliseconds"] for run in found)), scientific(largest['residual'], 2),
                        f"{max(rates):.3f}" if rates else "–", scientific(largest['error'], 1)])


def draw(images, runs, histories, found, element, segments, row):
    """Residuals on a coarse and on a fine mesh, iterations and condition numbers against h."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    # Okabe and Ito's colors, told apart by color-blind readers too; the dashes and markers say the same once more.
    styles = {
        "newton": ("#000000", "-", "o"), "splitting": ("#0072B2", "-", "s"), "splitting, clip": ("#56B4E9", "--", "D"),
        "splitting, printed": ("#56B4E9", ":", "P"), "fixed_point": ("#D55E00", "--", "^"),
        "psor dual": ("#CC79A7", "-", "v"), "psor dual, anderson": ("#CC79A7", "--", "<"),
        "psor primal, 1.6": ("#009E73", "-", ">"), "psor primal, 1.6, anderson": ("#009E73", "--", "h"),
        "extragradient": ("#E69F00", "-.", "X"),
    }
    figure, axes = plt.subplots(2, 2, figsize=(13, 10), layout="constrained")
    shown = (32, 128) if {32, 128} <= set(segments) else (segments[0], segments[-1])
    for axis, n in zip(axes[0], shown):
        for label, (color, dashes, marker) in styles.items():
            history = histories[element, ALONE, label, n, row]
            steps = np.arange(1, len(history) + 1)
            marked = np.unique(np.geomspace(1, len(history), 8).astype(int)) - 1
            axis.loglog(steps, history, color=color, linestyle=dashes, marker=marker, markevery=marked.tolist(),
                        markersize=5, linewidth=1.3, label=label)
        axis.set(title=f"Row {row}, {n} segments, {element}", xlabel="iteration", ylabel="residual",
                 ylim=(1e-11, 1e3))
    width = [SIDE / n for n in segments]
    for label, (color, dashes, marker) in styles.items():
        cases = [runs[element, ALONE, label, n, row] for n in segments]
        axes[1, 0].loglog(width, [case["iterations"] if case["converged"] else math.nan for case in cases], color=color,
                          linestyle=dashes, marker=marker, label=label)
    axes[1, 0].set(title=f"Row {row}, {element}: iterations to 1e-10, where it is reached", xlabel="h, mm",
                   ylabel="iterations")
    names = [name for name in found[element, segments[0]] if name.startswith("cond")]
    looks = (("black", "-", "o"), ("#0072B2", "-", "s"), ("#D55E00", "--", "^"), ("#56B4E9", "-", "D"),
             ("#E69F00", "--", "v"))
    for name, (color, dashes, marker) in zip(names, looks):
        axes[1, 1].loglog(width, [found[element, n][name] for n in segments], color=color, linestyle=dashes,
                          marker=marker, label=name)
    axes[1, 1].set(title=f"Condition numbers, pinned bar, {element}", xlabel="h, mm", ylabel="condition number")
    axes[1, 1].legend(frameon=False)
    for axis in axes[1]:
        axis.set_xticks(width, [f"{value:g}" for value in width])
        axis.minorticks_off()
        axis.invert_xaxis()
    for axis in axes.flat:
        axis.grid(color="0.9", linewidth=0.6)
    axes[0, 1].legend(loc="center left", bbox_to_anchor=(1.02, 0.5), frameon=False)
    for image in images:
        figure.savefig(image, dpi=100)


def main():
    def numbers(text):
        return [int(word) for word in text.split(",")]

    parser = argparse.ArgumentParser()
    parser.add_argument("--segments", type=numbers, default=[16, 32, 64, 128])
    parser.add_argument("--rows", type=numbers, default=list(range(1, len(ROWS) + 1)))
    parser.add_argument("--elements", type=lambda text: text.split(","), default=["quad4", "tri3"])
    parser.add_argument("--timings", type=int, default=3)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("images", nargs="*")
    arguments = parser.parse_args()
    segments, rows, elements = arguments.segments, arguments.rows, arguments.elements
    runs, histories, found, pin_effect = {}, {}, {}, 0.0
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for element in elements:
            for n in segments:
                found[element, n] = conditions(compliance(folder, element, n))
                for row in rows:
                    exact = {body: exact_forces(folder, row, element, n, body) for body in BODIES}
                    # The pinned node is not a contact point: it lacks in both halves.
                    alone = np.concatenate([half[:-1] for half in np.split(exact[ALONE], 2)])
                    pin_effect = max(pin_effect, np.abs(alone - exact[PINNED]).max() / np.abs(alone).max())
                    for body in BODIES:
                        for label in METHODS:
                            key = element, body, label, n, row
                            runs[key], histories[key] = measure(folder, label, row, element, n, body, exact[body],
                                                                     arguments.timings)
    with open(arguments.folder / "runs.csv", "w", newline="", encoding="utf-8") as table:
        writer = csv.DictWriter(table, next(iter(runs.values())))
        writer.writeheader()
        writer.writerows(runs.values())
    print_conditions(found, elements, segments)
    verdict = "less than 1e-10" if pin_effect < 1e-10 else scientific(pin_effect, 2)
    difference = "less than 1e-10" if pin_effect < 1e-10 else scientific(pin_effect, 2)
    print(f"\nThe forces of the pinned bar differ from those of the other by {difference} of the largest force.")
    for element in elements:
        for body in BODIES:
            print_runs(runs, element, body, segments, rows)
    if arguments.images:
        draw(arguments.images, runs, histories, found, elements[0], segments, rows[0])


if __name__ == "__main__":
    main()
