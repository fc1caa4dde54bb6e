"""Draws sweeps: the zones of the contact line, or a column of the table, over one quantity, or as maps over two; and
the forces of reduced problems."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Optional

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from amontons.cases import Case, CaseFault, dimension_of
from amontons.draw_line import PRESSURE, SHEAR, draw_history

ZONES = {"open_length": "#D55E00", "slip_length": "#0072B2", "stick_length": "#009E73"}


def value_in(row: dict[str, str], column: str) -> float:
    """A number of a case; not a number where the case was not solved."""
    return float(row[column] or "nan") if row["outcome"] == "solved" else np.nan


def quantity(column: str) -> str:
    """The words for a column of a sweep that is swept over."""
    return f"factor of {column.removeprefix('factor_')}" if column.startswith("factor_") else column.replace("_", " ")


def draw_curves(axes: Axes, values: list[float], rows: list[dict[str, str]], columns: Sequence[str]) -> None:
    """Columns over one quantity; cases that were not solved leave a gap."""
    marker = "." if len(rows) < 100 else None
    for column, style in zip(columns, ("-", "--", ":")):
        axes.plot(values, [value_in(row, column) for row in rows], marker=marker, color=ZONES.get(column, PRESSURE),
                  linestyle=style, label=column.replace("_", " "))
    axes.margins(y=0.08)


def draw_maps(figure: Figure, axes: Axes, quantities: Sequence[str], rows: list[dict[str, str]],
              columns: Sequence[str] = tuple(ZONES), marks: Sequence[Any] = (),
              unit_of: Callable[[str], str] = lambda column: "") -> None:
    """A map of each column over two quantities; what was not solved stays white. Marks are triples: place along the
    second quantity, along the first, and a label. Lengths of zones share their colors; the bar has the unit of the
    last column."""
    places = [np.unique([float(row[name]) for row in rows]) for name in quantities]
    limits = {}
    if columns[0] in ZONES:
        whole = [sum(value_in(row, zone) for zone in ZONES) for row in rows if row["outcome"] == "solved"]
        limits = {"vmin": 0.0, "vmax": max(whole, default=1.0)}
    for axis, column in zip(axes, columns):
        values = np.full([len(place) for place in places], np.nan)
        for row in rows:
            at = tuple(np.searchsorted(place, float(row[name])) for place, name in zip(places, quantities))
            values[at] = value_in(row, column)
        drawn = axis.pcolormesh(places[1], places[0], values, cmap="cividis", shading="nearest", rasterized=True,
                                **limits)
        axis.set(title=column.replace("_", " "), xlabel=quantity(quantities[1]))
        for x, y, label in marks:
            axis.plot(x, y, marker="o", markersize=12, markerfacecolor="white", markeredgecolor="black")
            axis.annotate(label, (x, y), ha="center", va="center", fontsize="small")
    axes[0].set(ylabel=quantity(quantities[0]))
    figure.colorbar(drawn, ax=axes).set_label(unit_of(columns[-1]))


def draw_sweep(case: Case, size: Sequence[float], field: Optional[str] = None) -> tuple[Figure, str]:
    """Draws a sweep over one or two quantities; of more, the first two that vary, the others at their first values.
    The field is the column that is drawn, the zones of the contact line by default."""
    summary, rows = case.summary, case.table("sweep")
    if field is not None and field not in rows[0]:
        raise CaseFault(f"{case.path}.sweep.csv: no column '{field}'; the columns are: {', '.join(rows[0])}")
    columns = tuple(ZONES) if field is None else (field,)
    names = [quantity["name"] for quantity in summary["quantities"] if quantity["values"] > 1]
    fixed = names[2:]
    rows = [row for row in rows if all(row[name] == rows[0][name] for name in fixed)]
    title = case.heading + "".join(f", {name} = {float(rows[0][name]):g}" for name in fixed)
    n_left = sum(row["outcome"] != "solved" for row in rows)
    if n_left:
        title += f"; {n_left} of {len(rows)} cases NOT SOLVED"
    if len(names) > 1 and not any(quantity["paired"] for quantity in summary["quantities"]):
        figure, axes = plt.subplots(1, len(columns), figsize=size, layout="constrained", sharey=True, squeeze=False)
        draw_maps(figure, axes[0], names[:2], rows, columns, unit_of=lambda column: case.unit(dimension_of(column)))
    else:
        figure, axes = plt.subplots(figsize=size, layout="constrained")
        name = names[0] if len(names) == 1 else "case"
        draw_curves(axes, [float(row[name]) for row in rows], rows, columns)
        axes.set(xlabel=quantity(name), ylabel=case.label("length", "L") if field is None else
                 case.label(field.replace("_", " "), dimension_of(field)))
        if len(columns) > 1:
            axes.legend(frameon=False)
    return figure, title


def draw_reduced(case: Case, size: Sequence[float]) -> tuple[Figure, str]:
    """Draws a reduced problem: the forces of its contacts, and the residuals."""
    figure, (above, below) = plt.subplots(2, 1, figsize=size, layout="constrained")
    rows = case.table("contact")
    numbers = [int(row["point"]) for row in rows]
    for name, color, marker in (("normal_force", PRESSURE, "o"), ("tangential_force", SHEAR, "x")):
        above.plot(numbers, [float(row[name]) for row in rows], color=color, marker=marker, markersize=4,
                   linestyle="none", label=name.replace("_", " "))
    above.set(xlabel="contact", ylabel=case.label("force", "F"))
    above.xaxis.get_major_locator().set_params(integer=True)
    above.legend(frameon=False)
    draw_history(below, case)
    return figure, case.heading
