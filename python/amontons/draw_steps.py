"""Draws load histories: the hysteresis loop, the zones of the contact line over the pseudo-time, and what friction took
along the line, or what it wore."""
from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Optional

import numpy as np
from matplotlib.colors import ListedColormap

from amontons.cases import Case, CaseFault, dimension_of
from amontons.draw_line import Canvas, Stretch, closed_part, names_of, points_of, stretches
from amontons.draw_sweep import ZONES as AREAS, quantity
from amontons.grid import Array

# In the order of the letters of run lengths.
ZONES = {"open": "#D55E00", "stick": "#009E73", "slip +": "#0072B2", "slip -": "#56B4E9", "slip": "#0072B2"}
LETTERS = "os+-*"
TEXTS = ("statuses",)
# What a history is about, the first that it has: the sums over several sets may cancel.
LOOPED = ("ux_1", "max_wear_depth", "preload_.*_force", "force_torque_.*", "tangential_force_1", "tangential_force")


def statuses_of(rows: list[dict[str, str]]) -> Array:
    """The status of each contact point (rows) at each step (columns), as its place in ZONES."""
    steps = [[LETTERS.index(letter) for length, letter in re.findall(r"(\d+)([os+*-])", row["statuses"])
              for _ in range(int(length))] for row in rows]
    return np.array(steps).T


def column(case: Case, rows: list[dict[str, str]], name: str) -> Array:
    """A column of the steps, as numbers."""
    names = [key for key in rows[0] if key not in TEXTS]
    if name not in names:
        raise CaseFault(f"{case.path}.history.csv: no column '{name}'; the columns are: {', '.join(names)}")
    return np.array([float(row[name]) for row in rows])


def default_loop(case: Case, rows: list[dict[str, str]]) -> Sequence[str]:
    """What is drawn over what if nobody says: the displacement of the first probe, the depth worn, the force of a
    preload, a torque or the tangential force, that of the first contact set where there are several. It is drawn over
    the number that turns back most often, of several the one that changes last and in most steps: a preload is applied
    and stays. A depth, which only grows, is drawn over the time."""
    def liveliness(name: str) -> tuple[int, int, int]:
        moves = np.diff(column(case, rows, name))
        steps = np.flatnonzero(moves)
        return int(np.sum(moves[steps[1:]]*moves[steps[:-1]] < 0)), int(steps.max(initial=-1)), len(steps)

    drawn = next(name for pattern in LOOPED for name in rows[0] if re.fullmatch(pattern, name))
    time = list(rows[0])[1]
    if drawn == "max_wear_depth":
        return time, drawn
    changes = [name for name in case.summary["load_history"]["changes"] if liveliness(name)[2] > 0]
    return max(changes, key=liveliness, default=time), drawn


def axis_label(case: Case, name: str) -> str:
    """The words for a column on an axis."""
    if re.fullmatch(r"u[xyz]_\d+", name):
        return case.label(f"{name[:2]} of probe {name[3:]}", "L")
    return case.label(quantity(name), dimension_of(name))


def draw_loop(axes: Canvas, case: Case, loop: Optional[Sequence[str]] = None) -> None:
    """One column of the steps over another, in the order of the steps; a dot at the end."""
    rows = case.table("history")
    over, name = loop or default_loop(case, rows)
    x, y = column(case, rows, over), column(case, rows, name)
    axes.plot(x, y, color="black", linewidth=0.8, marker="." if len(rows) < 50 else None)
    axes.plot(x[-1:], y[-1:], linestyle="none", marker="o", color="#D55E00", markersize=4)
    axes.set(xlabel=axis_label(case, over), ylabel=axis_label(case, name))


def shown_part(case: Case, rows: list[dict[str, str]]) -> list[Stretch]:
    """The contact sets, or where they close in some step if that is a small part of them."""
    return closed_part((statuses_of(rows) > 0).any(axis=1), stretches(case.line))


def draw_zones(axes: Canvas, case: Case) -> None:
    """The zones along the contact line over the pseudo-time; contact sets, or their pieces, follow each other, with
    nothing between. Of a solid their areas."""
    rows = case.table("history")
    if case.is_solid:
        draw_over_time(axes, case, [(name, color) for name, color in AREAS.items() if name in rows[0]],
                       case.label("area", "L²"))
        return
    sets = shown_part(case, rows)
    time = column(case, rows, list(rows[0])[1])
    states = statuses_of(rows)[points_of(sets)]
    starts = np.cumsum([len(one.points) for one in sets])[:-1]
    # A piece of one point is drawn about it, as far as there is room.
    places = np.maximum.accumulate(np.concatenate([edges(one.length) for one in sets]))
    axes.pcolormesh(edges(time, at_end=True), places, np.insert(states.astype(float), starts, np.nan, axis=0),
                    cmap=ListedColormap(list(ZONES.values())), vmin=-0.5, vmax=len(ZONES) - 0.5, rasterized=True)
    shown = [(name, color) for i, (name, color) in enumerate(ZONES.items()) if (states == i).any()]
    for name, color in shown:
        axes.plot([], [], linestyle="none", marker="s", markersize=6, color=color, label=name)
    axes.legend(frameon=False, ncols=len(shown), loc="lower center", bbox_to_anchor=(0.5, 1.0))
    axes.set(xlabel=list(rows[0])[1], ylabel=case.label("s", "L") + names_of(case, sets))


def draw_over_time(axes: Canvas, case: Case, columns: list[tuple[str, str]], label: str) -> None:
    """Columns of the steps, pairs of name and color, over the pseudo-time."""
    rows = case.table("history")
    time = list(rows[0])[1]
    for name, color in columns:
        axes.plot(column(case, rows, time), column(case, rows, name), color=color,
                  label=name.replace("_", " ") if len(columns) > 1 else None)
    axes.set(xlabel=time, ylabel=label)
    if len(columns) > 1:
        axes.legend(frameon=False)


def edges(places: Array, at_end: bool = False) -> Array:
    """Where the cells of places end: between them, or each at its place, if it stands for what led there."""
    if len(places) == 1:
        return np.array([places[0] - 0.5, places[0] + 0.5])
    if at_end:
        return np.concatenate([[places[0] - 0.5*(places[1] - places[0])], places])
    middle = 0.5*(places[1:] + places[:-1])
    return np.concatenate([[places[0]], middle, [places[-1]]])


def draw_wear_or_dissipation(axes: Canvas, case: Case) -> None:
    """The worn depth of each point of the contact line; without wear what friction took there, over its length. Of a
    solid all that friction took, over the pseudo-time."""
    table, history, largest = case.table("contact"), case.table("history"), 0.0
    wears = "max_wear_depth" in history[0]
    if case.is_solid:
        draw_over_time(axes, case, [("dissipation", "black")], axis_label(case, "dissipation"))
        return
    sets = shown_part(case, history)
    for one in sets:
        rows = [table[point] for point in one.points]
        taken = [float(row["wear_depth"]) if wears else float(row["dissipation"])/float(row["weight"]) for row in rows]
        axes.plot(one.length, taken, color="black")
        largest = max(largest, *taken)
    total = f"total {float(history[-1]['dissipation']):.4g} {case.unit('F L')}".rstrip()
    label = case.label("wear depth", "L") if wears else case.label("dissipation / length", "F")
    axes.set(xlabel=case.label("s", "L") + names_of(case, sets), ylabel=label, title="" if wears else total,
             ylim=(0.0, 1.05*largest or 1.0))
