"""Draws sweeps: the zones of the contact line or faces, or a column of the table, over one quantity, or as maps over
two; and the forces of reduced problems."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from matplotlib import colormaps

from amontons.cases import Case, CaseFault, dimension_of
from amontons.draw_line import PRESSURE, SHEAR, Canvas, count_abscissas
from amontons.grid import Array

# The zones of contact lines, and of solids those of contact faces.
ZONES = {f"{zone}_{measure}": color for measure in ("length", "area")
         for zone, color in (("open", "#D55E00"), ("slip", "#0072B2"), ("stick", "#009E73"))}
BETWEEN = 0.5  # of the way to the next value a cell of a map ends


def value_in(row: dict[str, str], column: str) -> float:
    """A number of a case; not a number where the case was not solved."""
    return float(row[column] or "nan") if row["outcome"] == "solved" else np.nan


def quantity(column: str) -> str:
    """The words for a column of a sweep that is swept over."""
    return f"factor of {column.removeprefix('factor_')}" if column.startswith("factor_") else column.replace("_", " ")


@dataclass(frozen=True)
class Study:
    """What is drawn of a sweep."""
    case: Case
    rows: list[dict[str, str]]
    columns: tuple[str, ...]     # what is drawn
    quantities: tuple[str, ...]  # over what: two of a map, one of curves
    title: str

    @property
    def is_map(self) -> bool:
        """Whether each column is a map over two quantities."""
        return len(self.quantities) > 1

    @property
    def limits(self) -> tuple[float, float]:
        """The values of the first and the last color of maps: those of zones have the whole line in common."""
        if self.columns[0] in ZONES:
            return 0.0, max((sum(value_in(row, zone) for zone in ZONES if zone in row) for row in self.rows
                             if row["outcome"] == "solved"), default=1.0)
        values = [value for row in self.rows if np.isfinite(value := value_in(row, self.columns[0]))] or [0.0]
        return min(values), max(values)


def study_of(case: Case, field: Optional[str] = None) -> Study:
    """What is drawn of a sweep over one or two quantities; of more, the first two that vary, the others at their first
    values. The field is the column that is drawn, the zones by default."""
    summary, rows = case.summary, case.table("sweep")
    if field is not None and field not in rows[0]:
        raise CaseFault(f"{case.path}.sweep.csv: no column '{field}'; the columns are: {', '.join(rows[0])}")
    names = [quantity["name"] for quantity in summary["quantities"] if quantity["values"] > 1]
    fixed = names[2:]
    rows = [row for row in rows if all(row[name] == rows[0][name] for name in fixed)]
    title = case.heading + "".join(f", {name} = {float(rows[0][name]):g}" for name in fixed)
    n_left = sum(row["outcome"] != "solved" for row in rows)
    if n_left:
        title += f"; {n_left} of {len(rows)} cases NOT SOLVED"
    is_map = len(names) > 1 and not any(quantity["paired"] for quantity in summary["quantities"])
    over = tuple(names[:2]) if is_map else (names[0] if len(names) == 1 else "case", )
    columns = tuple(zone for zone in ZONES if zone in rows[0]) if field is None else (field, )
    return Study(case, rows, columns, over, title)


def draw_curves(axes: Canvas, study: Study) -> None:
    """Columns over one quantity; cases that were not solved leave a gap."""
    name, = study.quantities
    for column, style in zip(study.columns, ("-", "--", ":")):
        axes.plot([float(row[name]) for row in study.rows], [value_in(row, column) for row in study.rows],
                  marker="." if len(study.rows) < 100 else None, color=ZONES.get(column, PRESSURE), linestyle=style,
                  label=column.replace("_", " ") if len(study.columns) > 1 else None)
    case, column = study.case, study.columns[0]
    words = column.split("_")[1] if len(study.columns) > 1 else column.replace("_", " ")
    axes.set(xlabel=quantity(name), ylabel=case.label(words, dimension_of(column)))
    if len(study.columns) > 1:
        axes.legend(frameon=False)


def draw_map(axes: Canvas, study: Study, column: str, marks: Sequence[Any] = ()) -> Any:
    """A column over two quantities; what was not solved stays white. Marks are triples: place along the second
    quantity, along the first, and a label. Returns what a bar of the colors is made of."""
    places = [np.unique([float(row[name]) for row in study.rows]) for name in study.quantities]
    values = np.full([len(place) for place in places], np.nan)
    for row in study.rows:
        at = tuple(np.searchsorted(place, float(row[name])) for place, name in zip(places, study.quantities))
        values[at] = value_in(row, column)
    low, high = study.limits
    drawn = axes.pcolormesh(ends_of(places[1]), ends_of(places[0]), values, cmap=colormaps["cividis"], vmin=low,
                            vmax=high, rasterized=True)
    axes.set(title=column.replace("_", " "), xlabel=quantity(study.quantities[1]))
    for x, y, label in marks:
        axes.plot(x, y, marker="o", markersize=12, markerfacecolor="white", markeredgecolor="black")
        axes.annotate(label, (x, y), ha="center", va="center", fontsize="small")
    return drawn


def ends_of(places: Array) -> Array:
    """Where the cells around places end: in the middle between two of them, and as far beyond the outer ones."""
    steps = BETWEEN*(np.diff(places) if len(places) > 1 else np.ones(1))
    return np.concatenate([[places[0] - steps[0]], places[:-1] + steps, [places[-1] + steps[-1]]])


def draw_forces(axes: Canvas, case: Case) -> None:
    """The forces of the contacts of a reduced problem."""
    rows = case.table("contact")
    numbers = [int(row["point"]) for row in rows]
    for name, color, marker in (("normal_force", PRESSURE, "o"), ("tangential_force", SHEAR, "s")):
        axes.plot(numbers, [float(row[name]) for row in rows], color=color, marker=marker, markersize=4,
                  linestyle="none", label=name.replace("_", " "))
    axes.set(xlabel="contact", ylabel=case.label("force", "F"))
    count_abscissas(axes)
    axes.legend(frameon=False)
