"""Draws cases from their files: the deformed body with its stress and contact points, pressure and shear with what
friction can bear, gap and slip, and the residuals of the iterations; where only a small part of the contact line is
closed, that part, and the body there once more; of a sweep, the zones of the contact line over the swept quantities.

Usage: amontons-plot CASE... A CASE is any file of a case, the path of its files without their endings, or a folder of
cases. Writes CASE.png and CASE.svg beside the files.
"""

import csv
import json
import pathlib
import sys

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from amontons.grid import read_grid

# Okabe and Ito's colours, told apart by colour-blind readers too; a marker says the same once more.
STATUSES = (("open", "#D55E00", "o"), ("stick", "#009E73", "s"), ("slip along t", "#0072B2", ">"),
            ("slip against t", "#56B4E9", "<"))
ZONES = {"open_length": "#D55E00", "slip_length": "#0072B2", "stick_length": "#009E73"}
PRESSURE, SHEAR, BOUND = "black", "#CC79A7", "#E69F00"
SUMMARY = ".summary.json"


def cases_of(arguments):
    """The paths of the cases that the arguments name, without the endings of their files."""
    cases = []
    for argument in map(pathlib.Path, arguments):
        if argument.is_dir():
            found = sorted(str(path)[: -len(SUMMARY)] for path in argument.glob("*" + SUMMARY))
        else:
            names = [str(argument)[: -len(ending)] for ending in
                     (SUMMARY, ".contact.csv", ".contact.vtu", ".sweep.csv", ".sweep.pvd", ".deck.nml", ".vtu", ".lst")
                     if str(argument).endswith(ending)] + [str(argument)]
            found = [name for name in names if pathlib.Path(name + SUMMARY).exists()][:1]
        if not found:
            sys.exit(f"plot: {argument}: no case is here; expected a folder with *{SUMMARY}, or the path of a case")
        cases += found
    return cases


def plain(text):
    """A text as matplotlib shows it unchanged: dollars stand for themselves, not for formulas."""
    return text.replace("$", r"\$")


def outlines(mesh, positions):
    """The polygon of each cell, middle nodes between their corners."""
    order = {"triangle": [0, 1, 2], "quad": [0, 1, 2, 3], "triangle6": [0, 3, 1, 4, 2, 5],
             "quad8": [0, 4, 1, 5, 2, 6, 3, 7], "quad9": [0, 4, 1, 5, 2, 6, 3, 7]}
    return [polygon for kind, nodes in mesh.cells for polygon in positions[nodes[:, order[kind]]]]


def boundary(mesh):
    """The edges that belong to one cell alone (pairs of nodes)."""
    corners = [nodes[:, :3 if kind.startswith("tri") else 4] for kind, nodes in mesh.cells]
    edges = np.concatenate([np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2) for cells in corners])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    return edges[first[count == 1]]


def magnification(mesh):
    """A round number that makes displacements visible: the largest then measures about a twelfth of the body.
    Displacements that are visible by themselves are drawn as they are, unless they are larger than the body."""
    largest = np.abs(mesh.point_data["displacement"]).max()
    if largest == 0.0:
        return 1.0
    size = np.ptp(mesh.points[:, :2], axis=0).max()
    wanted = size / 12.0 / largest
    if wanted < 1.0 and largest <= size:
        return 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted)


def draw_body(figure, axes, mesh, line, factor):
    """The mesh, its displacements multiplied by a factor, coloured by von Mises stress, its outline before, and the
    contact points by status. Returns where the contact points are drawn."""
    moved = mesh.points[:, :2] + factor * mesh.point_data["displacement"][:, :2]
    cells = outlines(mesh, moved)
    stress = mesh.cell_data["von_mises"]
    # A mesh so fine that its lines would hide the colours is drawn without them.
    is_fine = len(cells) > 2000
    drawn = axes.add_collection(PolyCollection(cells, array=stress, cmap="cividis", linewidths=0.2,
                                               edgecolors="face" if is_fine else "white", rasterized=is_fine))
    axes.add_collection(LineCollection(mesh.points[boundary(mesh)][:, :, :2], colors="grey", linestyles="--",
                                       linewidths=0.8))
    at = line.points[:, :2] + factor * line.point_data["displacement"][:, :2]
    for status, (label, color, marker) in enumerate(STATUSES, start=1):
        here = at[line.point_data["status"] == status]
        if len(here):
            axes.plot(*here.T, linestyle="none", marker=marker, color=color, markersize=4,
                      label=f"{label} ({len(here)})")
    axes.set(aspect="equal", xlabel="x", ylabel="y",
             title="von Mises stress; displacements " + ("as they are" if factor == 1.0 else
                                                        f"times {factor:g}"))
    axes.autoscale_view()
    if len(at):
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=4.0, ncols=2, frameon=False)
    figure.colorbar(drawn, ax=axes, shrink=0.8)
    return at


def draw_detail(figure, axes, mesh, line, shown):
    """The body once more, near the contact points that are shown. Displacements that are large beside such a part would
    bend it out of shape if they were magnified."""
    at = draw_body(figure, axes, mesh, line, 1.0)[shown]
    axes.get_legend().remove()
    axes.collections[0].colorbar.remove()
    middle, half = (at.min(axis=0) + at.max(axis=0)) / 2, np.ptp(at, axis=0).max() / 2
    axes.set(xlim=middle[0] + np.array([-1.0, 1.0]) * half, ylim=middle[1] + np.array([-0.4, 0.4]) * half,
             xlabel="", ylabel="", title="the closed part, displacements as they are")


def closed_part(line, sets):
    """The range of lengths where the contact line is closed and somewhat more, if that is a small part of the line;
    the whole of it else."""
    lengths = np.concatenate([length for _, length in sets])
    closed = lengths[np.concatenate([line.point_data["status"][points] > 1 for points, _ in sets])]
    whole = lengths[0], lengths[-1]
    if not len(closed):
        return whole
    near = np.sort(np.abs(lengths - closed.mean()))
    margin = max(np.ptp(closed), 3 * near[min(2, len(near) - 1)])
    part = max(closed.min() - margin, whole[0]), min(closed.max() + margin, whole[1])
    return part if part[1] - part[0] < 0.4 * (whole[1] - whole[0]) else whole


def cropped(sets, part):
    """The contact sets, without the points outside a range of lengths, and without sets that have none left."""
    inside = [(length >= part[0]) & (length <= part[1]) for _, length in sets]
    return [(points[here], length[here]) for (points, length), here in zip(sets, inside) if here.any()]


def stretches(line):
    """The contact sets: for each the points and their lengths along the line, one set behind the other."""
    result, start = [], 0.0
    for number in np.unique(line.point_data["set"]):
        points = np.flatnonzero(line.point_data["set"] == number)
        steps = np.linalg.norm(np.diff(line.points[points], axis=0), axis=1)
        length = start + np.concatenate([[0.0], np.cumsum(steps)])
        result.append((points, length))
        start = length[-1] + 0.05 * max(length[-1], 1e-300)
    return result


def draw_stresses(axes, line, sets):
    """Pressure, shear and the shear that friction can bear along the contact line, statuses as markers."""
    data = line.point_data
    for i, (points, length) in enumerate(sets):
        names = ("pressure", "shear", "bound of the shear") if i == 0 else (None,) * 3
        axes.plot(length, data["contact_pressure"][points], color=PRESSURE, label=names[0])
        axes.plot(length, data["contact_shear"][points], color=SHEAR, label=names[1])
        for sign in (1, -1):
            axes.plot(length, sign * data["shear_bound"][points], color=BOUND, linestyle=":",
                      label=names[2] if sign > 0 else None)
        for status, (_, color, marker) in enumerate(STATUSES, start=1):
            here = data["status"][points] == status
            axes.plot(length[here], data["contact_pressure"][points][here], linestyle="none", marker=marker,
                      color=color, markersize=3.5, markevery=max(1, len(points) // 60))
    axes.set(ylabel="contact stress")
    axes.legend(loc="best", frameon=False, fontsize="small")


def draw_motion(axes, line, sets, longest):
    """Gap and slip along the contact line.

    Where the body's normal all but misses the obstacle, the gap along it has no end and would flatten all others: the
    axis ends at twice the usual gap, or where slips can still be seen.
    """
    data, points = line.point_data, np.concatenate([points for points, _ in sets])
    gaps = data["gap"][points]
    gaps = gaps[(gaps > 0.0) & (gaps <= longest)]
    slips = data["slip"][points]
    limit = max(4.0 * np.abs(slips).max(), 2.0 * np.median(gaps) if len(gaps) else 0.0)
    for name, color, style in (("gap", "#D55E00", "-"), ("slip", "#0072B2", "--")):
        for points, length in sets:
            values = data[name][points]
            axes.plot(length, np.where(np.abs(values) > longest, np.nan, values), color=color, linestyle=style,
                      label=name if length is sets[0][1] else None)
    axes.set(xlabel="length along the contact line", ylabel="gap, slip")
    if 0.0 < limit < axes.get_ylim()[1]:
        bottom = min(0.0, slips.min())
        axes.set_ylim(bottom - 0.05 * (limit - bottom), limit)
    axes.legend(loc="best", frameon=False, fontsize="small")


def draw_history(axes, summary):
    """The residual after each iteration."""
    history = [residual for residual in summary["history"] if residual]
    axes.semilogy(range(1, len(history) + 1), history, color="black", linewidth=0.8,
                  marker="." if len(history) < 100 else None)
    verdict = "converged" if summary["converged"] else "NOT CONVERGED"
    axes.set(xlabel=f"iteration of {summary['method']}", ylabel="residual",
             title=f"{verdict}, residual {summary['residual']:.1e}; certificate "
             + ("passed" if summary["certificate"]["passed"] else "FAILED"))
    axes.xaxis.get_major_locator().set_params(integer=True)


def length_in(row, zone):
    """The length of a zone of the contact line in a case; not a number where the case was not solved."""
    return float(row[zone]) if row["outcome"] == "converged" else np.nan


def draw_parts(axes, values, rows):
    """The zones of the contact line over one quantity; cases that were not solved leave a gap."""
    marker = "." if len(rows) < 100 else None
    for (zone, color), style in zip(ZONES.items(), ("-", "--", ":")):
        axes.plot(values, [length_in(row, zone) for row in rows], marker=marker, color=color,
                  linestyle=style, label=zone.removesuffix("_length"))
    axes.legend(frameon=False)
    axes.set(ylabel="length")


def quantity(column):
    """The words for a column of a sweep that is swept over."""
    return f"factor of {column.removeprefix('factor_')}" if column.startswith("factor_") else column


def draw_maps(figure, axes, columns, rows, marks):
    """A map of each zone over two quantities; what was not solved stays white."""
    places = [np.unique([float(row[column]) for row in rows]) for column in columns]
    whole = max((sum(length_in(row, zone) for zone in ZONES) for row in rows if row["outcome"] == "converged"),
                default=1.0)
    for axis, zone in zip(axes, ZONES):
        values = np.full([len(place) for place in places], np.nan)
        for row in rows:
            at = tuple(np.searchsorted(place, float(row[column])) for place, column in zip(places, columns))
            values[at] = length_in(row, zone)
        drawn = axis.pcolormesh(places[1], places[0], values, cmap="cividis", vmin=0.0, vmax=whole, shading="nearest",
                                rasterized=True)
        axis.set(title=zone.replace("_", " "), xlabel=quantity(columns[1]))
        for x, y, label in marks:
            axis.plot(x, y, marker="o", markersize=12, markerfacecolor="white", markeredgecolor="black")
            axis.annotate(label, (x, y), ha="center", va="center", fontsize="small")
    axes[0].set(ylabel=quantity(columns[0]))
    figure.colorbar(drawn, ax=axes)


def draw_sweep(summary, rows, marks=()):
    """Draws a sweep over one or two quantities; of more, the first two that vary, the others at their first values.
    Marks are triples: place along the second quantity, along the first, and a label."""
    columns = [quantity["name"] for quantity in summary["quantities"] if quantity["values"] > 1]
    fixed = columns[2:]
    rows = [row for row in rows if all(row[name] == rows[0][name] for name in fixed)]
    title = (summary["title"] or summary["case"]) + "".join(f", {name} = {float(rows[0][name]):g}" for name in fixed)
    n_left = sum(row["outcome"] != "converged" for row in rows)
    if n_left:
        title += f"; {n_left} of {len(rows)} cases NOT SOLVED"
    if len(columns) > 1 and not any(quantity["paired"] for quantity in summary["quantities"]):
        figure, axes = plt.subplots(1, 3, figsize=(14, 4.6), layout="constrained", sharey=True)
        draw_maps(figure, axes, columns[:2], rows, marks)
    else:
        figure, axes = plt.subplots(figsize=(8, 5), layout="constrained")
        name = columns[0] if len(columns) == 1 else "case"
        draw_parts(axes, [float(row[name]) for row in rows], rows)
        axes.set(xlabel=name)
    figure.suptitle(plain(title))
    return figure


def draw_reduced(summary, rows):
    """Draws a reduced problem: the forces of its contacts, and the residuals."""
    figure, (above, below) = plt.subplots(2, 1, figsize=(9, 7), layout="constrained")
    numbers = [int(row["point"]) for row in rows]
    for name, color, marker in (("normal_force", PRESSURE, "o"), ("tangential_force", SHEAR, "x")):
        above.plot(numbers, [float(row[name]) for row in rows], color=color, marker=marker, markersize=4,
                   linestyle="none", label=name.replace("_", " "))
    above.set(xlabel="contact", ylabel="force")
    above.xaxis.get_major_locator().set_params(integer=True)
    above.legend(frameon=False)
    draw_history(below, summary)
    figure.suptitle(plain(summary["title"] or summary["case"]))
    return figure


def rows_of(case, table):
    """The rows of a table of a case."""
    with open(f"{case}.{table}.csv", newline="", encoding="utf-8") as text:
        return list(csv.DictReader(text))


def draw_case(case, summary):
    """Draws one case."""
    mesh, line = read_grid(f"{case}.vtu"), read_grid(f"{case}.contact.vtu")
    sets = stretches(line)
    part = closed_part(line, sets) if sets else None
    shown = cropped(sets, part) if sets else []
    is_detail = sum(len(points) for points, _ in shown) < len(line.points)
    figure, axes = plt.subplot_mosaic([["body", "stresses"], ["body", "motion"],
                                       ["detail" if is_detail else "body", "history"]],
                                      figsize=(12, 8), width_ratios=(1.15, 1), layout="constrained")
    figure.suptitle(plain(summary["title"] or summary["case"]))
    draw_body(figure, axes["body"], mesh, line, magnification(mesh))
    if sets:
        draw_stresses(axes["stresses"], line, shown)
        draw_motion(axes["motion"], line, shown, sets[-1][1][-1])
    else:
        axes["stresses"].set_axis_off()
        axes["motion"].set_axis_off()
    if is_detail:
        draw_detail(figure, axes["detail"], mesh, line, np.concatenate([points for points, _ in shown]))
        axes["motion"].set(xlabel=f"length along the contact line, {part[0]:.4g} to {part[1]:.4g} of "
                           f"{sets[-1][1][-1]:.4g}")
    draw_history(axes["history"], summary)
    return figure


def save_case(case, *files):
    """Draws one case into files: names that tell their format by their ending, or an open one for SVG."""
    summary = json.loads(pathlib.Path(case + SUMMARY).read_text(encoding="utf-8"))
    if "sweep" in summary:
        figure = draw_sweep(summary, rows_of(case, "sweep"))
    elif "problem" in summary:
        figure = draw_reduced(summary, rows_of(case, "contact"))
    else:
        figure = draw_case(case, summary)
    for file in files:
        # In an SVG only what is fine-grained has a resolution, and it may be looked at more closely.
        if isinstance(file, str) and file.endswith(".png"):
            figure.savefig(file, dpi=110)
        else:
            figure.savefig(file, dpi=220, format="svg")
    plt.close(figure)


def main(arguments):
    """Draws the cases that the arguments name."""
    matplotlib.use("Agg")
    if not arguments:
        sys.exit("plot: name a case: any of its files, or the folder it is in")
    for case in cases_of(arguments):
        files = (f"{case}.png", f"{case}.svg")
        save_case(case, *files)
        print(*files, sep="\n")
