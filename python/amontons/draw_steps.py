"""Draws load histories: the hysteresis loop, the zones of the contact line over the pseudo-time, and what friction took
along the line."""
from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Optional

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from amontons.cases import Case, CaseFault, dimension_of
from amontons.draw_line import stretches
from amontons.draw_sweep import quantity
from amontons.grid import Array

# In the order of the letters of run lengths.
ZONES = {"open": "#D55E00", "stick": "#009E73", "slip +": "#0072B2", "slip -": "#56B4E9"}
LETTERS = "os+-"
TEXTS = ("statuses",)


def statuses_of(rows: list[dict[str, str]]) -> Array:
    """The status of each contact point (rows) at each step (columns), as its place in ZONES."""
    steps = [[LETTERS.index(letter) for length, letter in re.findall(r"(\d+)([os+-])", row["statuses"])
              for _ in range(int(length))] for row in rows]
    return np.array(steps).T


def column(case: Case, rows: list[dict[str, str]], name: str) -> Array:
    """A column of the steps, as numbers."""
    names = [key for key in rows[0] if key not in TEXTS]
    if name not in names:
        raise CaseFault(f"{case.path}.history.csv: no column '{name}'; the columns are: {', '.join(names)}")
    return np.array([float(row[name]) for row in rows])


def default_loop(case: Case, rows: list[dict[str, str]]) -> Sequence[str]:
    """What is drawn over what if nobody says: the displacement of the first probe, or else the tangential force, over
    the number that turns back most often, of several the one that changes in most steps: a preload is applied and
    stays."""
    def liveliness(name: str) -> tuple[int, int]:
        moves = np.diff(column(case, rows, name))
        moves = moves[moves != 0]
        return int(np.sum(moves[1:]*moves[:-1] < 0)), len(moves)

    changes = [name for name in case.summary["load_history"]["changes"] if liveliness(name)[1] > 0]
    over = max(changes, key=liveliness, default=list(rows[0])[1])
    return over, "ux_1" if "ux_1" in rows[0] else "tangential_force"


def axis_label(case: Case, name: str) -> str:
    """The words for a column on an axis."""
    if re.fullmatch(r"u[xy]_\d+", name):
        return case.label(f"{name[:2]} of probe {name[3:]}", "L")
    return case.label(quantity(name), dimension_of(name))


def draw_loop(axes: Axes, case: Case, rows: list[dict[str, str]], loop: Optional[Sequence[str]] = None) -> None:
    """One column of the steps over another, in the order of the steps; a dot at the end."""
    over, name = loop or default_loop(case, rows)
    x, y = column(case, rows, over), column(case, rows, name)
    axes.plot(x, y, color="black", linewidth=0.8, marker="." if len(rows) < 50 else None)
    axes.plot(x[-1], y[-1], marker="o", color="#D55E00", markersize=4)
    axes.set(xlabel=axis_label(case, over), ylabel=axis_label(case, name))


def draw_zones(axes: Axes, case: Case, rows: list[dict[str, str]]) -> None:
    """The zones along the contact line over the pseudo-time; contact sets follow each other."""
    sets = stretches(case.line)
    place = np.concatenate([one.length for one in sets])
    order = np.concatenate([one.points for one in sets])
    time = column(case, rows, list(rows[0])[1])
    states = statuses_of(rows)[order]
    axes.pcolormesh(edges(time, at_end=True), edges(place), states, cmap=ListedColormap(list(ZONES.values())),
                    vmin=-0.5, vmax=len(ZONES) - 0.5, rasterized=True)
    shown = [Patch(color=color, label=name) for i, (name, color) in enumerate(ZONES.items()) if (states == i).any()]
    axes.legend(handles=shown, frameon=False, ncols=len(shown), loc="lower center", bbox_to_anchor=(0.5, 1.0))
    axes.set(xlabel=list(rows[0])[1], ylabel=case.label("s", "L"))


def edges(places: Array, at_end: bool = False) -> Array:
    """Where the cells of places end: between them, or each at its place, if it stands for what led there."""
    if len(places) == 1:
        return np.array([places[0] - 0.5, places[0] + 0.5])
    if at_end:
        return np.concatenate([[places[0] - 0.5*(places[1] - places[0])], places])
    middle = 0.5*(places[1:] + places[:-1])
    return np.concatenate([[places[0]], middle, [places[-1]]])


def draw_dissipation(axes: Axes, case: Case, rows: list[dict[str, str]]) -> None:
    """What friction took at each point of the contact line, over its length."""
    table = case.table("contact")
    for one in stretches(case.line):
        taken = [float(table[point]["dissipation"])/float(table[point]["weight"]) for point in one.points]
        axes.plot(one.length, taken, color="black")
    axes.set(xlabel=case.label("s", "L"), ylabel=case.label("dissipation / length", "F"), ylim=(0, None))
    total = f"total {float(rows[-1]['dissipation']):.4g} {case.unit('F L')}".rstrip()
    axes.set_title(total, fontsize="small", loc="right")


def draw_steps(case: Case, size: Sequence[float], loop: Optional[Sequence[str]] = None) -> Figure:
    """Draws a load history."""
    rows = case.table("history")
    figure, axes = plt.subplots(1, 3, figsize=size, layout="constrained", width_ratios=[1.1, 1.3, 1])
    draw_loop(axes[0], case, rows, loop)
    draw_zones(axes[1], case, rows)
    draw_dissipation(axes[2], case, rows)
    return figure
