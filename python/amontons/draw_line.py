"""Draws the contact line: pressure and shear with what friction can bear, slip, gap; and the residuals of a method."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
from matplotlib.axes import Axes

from amontons.cases import Case
from amontons.grid import Array, Grid
from amontons.numerals import scientific
from amontons.svg_axes import SvgAxes

Canvas = Union[Axes, SvgAxes]
# Okabe and Ito's colors, told apart by color-blind readers too; a marker says the same once more.
STATUSES = (("open", "#D55E00", "o"), ("stick", "#009E73", "s"), ("slip along t", "#0072B2", ">"),
            ("slip against t", "#56B4E9", "<"), ("slip", "#0072B2", ">"))
PRESSURE, SHEAR, BOUND, GAP, SLIP = "black", "#CC79A7", "#E69F00", "#D55E00", "#0072B2"
ABSCISSAS = ("s", "x", "y")
ROUNDING = 1e-9  # what is smaller over the largest value or displacement is drawn as 0
DETAIL = 0.35    # what is smaller over the size of the body is drawn once more
LARGE_GAP = 6    # times the median gap of the open points: the others would be flattened


@dataclass(frozen=True)
class Stretch:
    """A contact set along the contact line, or a piece of it where it has holes."""
    points: Array  # its contact points, in order
    place: Array   # their places on the abscissa of the panels [L]
    length: Array  # their lengths along the line, one set behind the other [L]


def stretches(line: Grid, abscissa: str = "s") -> list[Stretch]:
    """The contact sets of a line in their pieces, one behind the other."""
    result, start = [], 0.0
    joined = {tuple(sorted(ends)) for kind, cells in line.cells if kind == "line" for ends in cells.tolist()}
    for number in np.unique(line.point_data["set"]):
        points = np.flatnonzero(line.point_data["set"] == number)
        steps = np.linalg.norm(np.diff(line.points[points], axis=0), axis=1)
        length = start + np.concatenate([[0.0], np.cumsum(steps)])
        place = length if abscissa == "s" else line.points[points, ABSCISSAS.index(abscissa) - 1]
        holes = [i for i, ends in enumerate(zip(points[:-1], points[1:]), 1) if tuple(sorted(ends)) not in joined]
        result += [Stretch(*piece) for piece in zip(*(np.split(one, holes) for one in (points, place, length)))]
        start = length[-1] + 0.05 * max(length[-1], 1e-300)
    return result


def closed_part(is_closed: Array, sets: list[Stretch]) -> list[Stretch]:
    """The sets where the contact line is closed (n_points) and somewhat more, if that is a small part of the line; else
    all."""
    lengths = np.concatenate([one.length for one in sets])
    closed = lengths[np.concatenate([is_closed[one.points] for one in sets])]
    if not len(closed):
        return sets
    near = np.sort(np.abs(lengths - closed.mean()))
    margin = max(np.ptp(closed), 3 * near[min(2, len(near) - 1)])
    first, last = max(closed.min() - margin, lengths[0]), min(closed.max() + margin, lengths[-1])
    if last - first >= 0.4 * (lengths[-1] - lengths[0]):
        return sets
    inside = [(one.length >= first) & (one.length <= last) for one in sets]
    return [Stretch(one.points[here], one.place[here], one.length[here])
            for one, here in zip(sets, inside) if here.any()]


def closed_zone(line: Grid, sets: list[Stretch]) -> list[Stretch]:
    """Of the set with the largest pressure, where it is closed and somewhat more, if that is a small part of it."""
    number = line.point_data["set"][np.argmax(line.point_data["contact_pressure"])]
    return closed_part(line.point_data["status"] > 1,
                       [one for one in sets if line.point_data["set"][one.points[0]] == number])


def points_of(sets: list[Stretch]) -> Array:
    """The contact points of some sets."""
    return np.concatenate([one.points for one in sets])


def has_detail(case: Case, sets: list[Stretch], zone: list[Stretch]) -> bool:
    """Whether the closed zone is a small part of its contact set or of the body."""
    def extent(points: Array) -> float:
        return float(np.ptp(points[:, :2], axis=0).max())
    if not sets:
        return False
    points, numbers = points_of(zone), case.line.point_data["set"]
    width = extent(case.line.points[points])
    is_part = len(points) < np.sum(numbers == numbers[points[0]])
    return width > 0.0 and bool(is_part or width < DETAIL * extent(case.mesh.points))


def draw_lines(axes: Canvas, sets: list[Stretch], values: Array, color: str, label: Optional[str] = None,
               style: Any = "-") -> None:
    """A quantity along every set."""
    for one in sets:
        axes.plot(one.place, values[one.points], color=color, linestyle=style, label=label if one is sets[0] else None)


def set_range(axes: Canvas, values: Array, scale: float) -> None:
    """The range of the ordinate: zero and all values; rounding errors are not magnified."""
    values = values[np.isfinite(values)]
    low, high = min(values.min(initial=0.0), 0.0), max(values.max(initial=0.0), 0.0)
    if high - low <= ROUNDING * scale:
        low, high = -(scale or 1.0) * 1e-3, (scale or 1.0) * 1e-3
        axes.set_yticks([0.0])
    margin = 0.06 * (high - low)
    axes.set_ylim(low - margin, high + margin)
    axes.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True)


def draw_stress(axes: Canvas, case: Case, sets: list[Stretch]) -> None:
    """Pressure, shear and the shear that friction can bear, statuses as markers."""
    data = case.line.point_data
    pressure, shear, bound = (data[name] for name in ("contact_pressure", "contact_shear", "shear_bound"))
    if "contact_shear_theta" in data:
        shear = np.hypot(shear, data["contact_shear_theta"])
    if bound.any():
        draw_lines(axes, sets, bound, BOUND, "friction bound", ":")
        draw_lines(axes, sets, -bound, BOUND, None, ":")
    draw_lines(axes, sets, pressure, PRESSURE, "pressure")
    draw_lines(axes, sets, shear, SHEAR, "shear", (0, (6, 1)))
    for one in sets:
        for status, (_, color, marker) in enumerate(STATUSES, start=1):
            here = data["status"][one.points] == status
            axes.plot(one.place[here], pressure[one.points][here], linestyle="none", marker=marker, color=color,
                      markersize=2.5, markevery=max(1, len(one.points) // 60))
    shown = points_of(sets)
    values = np.concatenate([pressure[shown], shear[shown], bound[shown], -bound[shown]])
    set_range(axes, values, np.abs(values).max(initial=0.0))
    axes.set(ylabel=case.label("contact stress", "F/L²"))
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, frameon=False, ncols=3)


def draw_slip(axes: Canvas, case: Case, sets: list[Stretch]) -> None:
    """The slip; of a twisted body its length, with arrows in its direction where the set is unrolled: along the contact
    line to the right, around the axis upwards."""
    slip = case.line.point_data["slip"]
    ends = slip[points_of(sets)]
    if "slip_theta" in case.line.point_data:
        along, around = slip, case.line.point_data["slip_theta"]
        slip = np.hypot(along, around)
        # Room for the arrows, which are about a third of the axis long.
        ends = np.append(slip[points_of(sets)], slip.max() * np.where(around.min() < 0.0, [-0.4, 1.4], [0.0, 1.4]))
        slides = (case.line.point_data["status"] > 1) & (slip > ROUNDING * slip.max())
        for one in sets:
            here = slides[one.points].nonzero()[0][::max(1, len(one.points) // 20)]
            points, way = one.points[here], np.sign(one.place[-1] - one.place[0])
            axes.quiver(one.place[here], slip[points], way * along[points] / slip[points],
                        around[points] / slip[points], color=SLIP, angles="uv", units="inches", width=0.012,
                        scale=6.0, scale_units="inches")
    draw_lines(axes, sets, slip, SLIP)
    set_range(axes, ends, np.abs(case.mesh.point_data["displacement"]).max())
    axes.axhline(0, color="gray", linewidth=0.4)
    axes.set(ylabel=case.label("slip", "L"))


def draw_gap(axes: Canvas, case: Case, sets: list[Stretch]) -> None:
    """The gap. Where the body's normal all but misses the obstacle it has no end and would flatten all others: the axis
    then ends at three times the usual gap."""
    gap = case.line.point_data["gap"]
    size = np.ptp(case.mesh.points[:, :2], axis=0).max()
    gap = np.where(np.abs(gap) > size, np.nan, gap)
    draw_lines(axes, sets, gap, GAP)
    shown = points_of(sets)
    open_gaps = gap[shown][(case.line.point_data["status"][shown] == 1) & np.isfinite(gap[shown])]
    usual = np.median(open_gaps) if len(open_gaps) else 0.0
    shown = gap[shown]
    is_endless = 0.0 < LARGE_GAP * usual < np.nanmax(shown, initial=0.0)
    set_range(axes, np.minimum(shown, 3 * usual) if is_endless else shown,
              np.abs(case.mesh.point_data["displacement"]).max())
    axes.set(ylabel=case.label("gap", "L"))


LINE_PANELS = {"stress": draw_stress, "slip": draw_slip, "gap": draw_gap}


def names_of(case: Case, sets: list[Stretch]) -> str:
    """The names of several contact sets that follow each other, for the end of a label; of one set there is none."""
    numbers = list(dict.fromkeys(int(case.line.point_data["set"][one.points[0]]) for one in sets))
    try:
        names = [str(contact.get("name") or contact["set"]) for contact in (case.contacts[n - 1] for n in numbers)]
    except (OSError, LookupError):
        return ""
    return f": {', '.join(names)}" if len(names) > 1 else ""


def abscissa_label(case: Case, abscissa: str, sets: list[Stretch], whole: list[Stretch]) -> str:
    """The label of the abscissa of the contact line."""
    if abscissa != "s":
        return case.label(abscissa, "L")
    text = case.label("length along the contact line", "L") + names_of(case, sets)
    if sets is whole or not sets:
        return text
    return text + f", {sets[0].length[0]:.4g} to {sets[-1].length[-1]:.4g} of {whole[-1].length[-1]:.4g}"


def residual_text(residual: float) -> str:
    """A residual as it is written."""
    return scientific(residual, 2) if residual else "0"


def count_abscissas(axes: Canvas) -> None:
    """Has ticks of the abscissa at whole numbers only."""
    if isinstance(axes, SvgAxes):
        axes.has_whole_abscissas = True
    else:
        axes.xaxis.get_major_locator().set_params(integer=True, min_n_ticks=1)


def draw_history(axes: Canvas, case: Case) -> None:
    """The residual after each iteration."""
    summary = case.summary
    history = [residual for residual in summary["residual_history"] if residual]
    axes.set_yscale("log")
    if not history:
        axes.set_yticks([])
    axes.plot(range(1, len(history) + 1), history, color="black", linewidth=0.8,
                  marker="." if len(history) < 100 else None)
    verdict = "converged" if summary["converged"] else "NOT CONVERGED"
    axes.set(xlabel=f"iteration of {summary['method']}", ylabel="residual",
             title=f"{verdict}, residual {residual_text(summary['residual'])}; certificate "
             + ("passed" if summary["certificate"]["passed"] else "FAILED"))
    count_abscissas(axes)
