"""Draws solved cases: the deformed body with a field, its contact points and obstacles; contact stress, slip and gap
along the contact line; the residuals. Where only a small part of the line is closed, that part is shown, and the
body there once more. Of a solid: both its sides, and maps of pressure, statuses and slip of its contact sets. Of a
sweep: the zones of the contact line over the swept quantities. Writes CASE.png and CASE.svg beside the files of the
case; of a load history, CASE.steps.png and CASE.steps.svg too: its loop, the zones over the pseudo-time, the
dissipation or the worn depth along the line."""
from __future__ import annotations

import argparse
import os
import sys
import textwrap
from collections.abc import Callable, Sequence
from typing import Any, Optional, Union

import matplotlib
import matplotlib.figure
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from amontons.cases import Case, CaseFault, dimension_of, find_cases
from amontons.commands import Parser
from amontons.draw_body import FIELD, draw_body, draw_detail
from amontons.draw_line import (ABSCISSAS, LINE_PANELS, Stretch, abscissa_label, closed_part, closed_zone,
                                draw_history, has_detail, points_of, stretches)
from amontons.draw_steps import draw_loop, draw_wear_or_dissipation, draw_zones
from amontons.draw_solid import NODAL_FIELD, QUANTITIES, draw_map as draw_contact_map, draw_solid, maps_of, part_of
from amontons.draw_sweep import draw_curves, draw_forces, draw_map, quantity, study_of

FORMATS = ("png", "svg", "pdf")
BODY_PANELS = {"body": draw_body, "detail": draw_detail}
PANELS = (*BODY_PANELS, *LINE_PANELS, "history")
HEIGHTS = {"body": 2.0, "stress": 1.4}  # of panels, over that of the others
INCH = 25.4  # mm
LOW = 0.7  # height of the residuals of a solid over that of a map
BROAD = 0.8  # height over width of a place from which on the two sides of a solid are one above the other
LABEL_LETTERS = 6.5  # of a label below a panel, for each inch of the figure
SIZES = {"body": (240, 165), "sweep": (240, 85), "curve": (150, 95), "reduced": (170, 140), "steps": (240, 80)}  # mm
STYLE = {"font.size": 8, "axes.titlesize": "medium", "axes.linewidth": 0.5, "lines.linewidth": 1.0,
         "xtick.major.width": 0.5, "ytick.major.width": 0.5, "legend.fontsize": "small", "savefig.dpi": 200,
         "axes.formatter.use_mathtext": True, "svg.fonttype": "none", "pdf.fonttype": 42}


def plain(text: str) -> str:
    """A text as matplotlib shows it unchanged: dollars stand for themselves, not for formulas."""
    return text.replace("$", r"\$")


def draw_panels(case: Case, panels: Sequence[Any], size: Sequence[float], field: str = FIELD,
                scale: Optional[float] = None, abscissa: str = "s") -> Figure:
    """A figure of a body with the panels named, those of the body on the left."""
    sets = stretches(case.line, abscissa)
    shown = closed_part(case.line.point_data["status"] > 1, sets) if sets else sets
    zone = closed_zone(case.line, sets) if sets else sets
    left = [name for name in panels if name in BODY_PANELS and (name != "detail" or has_detail(case, sets, zone))]
    right = [name for name in panels if name not in BODY_PANELS and (sets or name == "history")]
    columns = [column for column in (left, right) if column]
    if not columns:
        raise CaseFault(f"{case.path}: nothing to show in the panels {', '.join(panels)}")
    drawn = plt.figure(figsize=size, layout="constrained")
    parts = drawn.subfigures(1, len(columns), squeeze=False, width_ratios=[1.15, 1.0][:len(columns)])[0]
    for part, column in zip(parts, columns):
        axes = part.subplots(len(column), 1, squeeze=False, height_ratios=[HEIGHTS.get(name, 1.0) for name in column])
        axes = dict(zip(column, axes[:, 0]))
        for name in column:
            if name == "body":
                draw_body(axes[name], case, field, scale)
            elif name == "detail":
                draw_detail(axes[name], case, field, points_of(zone), scale)
            elif name == "history":
                draw_history(axes[name], case)
        label = textwrap.fill(abscissa_label(case, abscissa, shown, sets), int(LABEL_LETTERS * size[0]))
        draw_line([(name, axes[name]) for name in column if name in LINE_PANELS], case, shown, label)
    return drawn


def draw_solid_panels(case: Case, panels: Sequence[Any], size: Sequence[float], field: Optional[str],
                      scale: Optional[float]) -> Figure:
    """A figure of a solid with the panels named: both sides of the body on the left, a row for each contact set on the
    right."""
    maps = maps_of(case)
    columns = [name for name in panels if name in QUANTITIES and maps]
    has_history = "history" in panels
    if not columns and not {"body", "history"} & set(panels):
        raise CaseFault(f"{case.path}: nothing to show in the panels {', '.join(panels)}")
    drawn = plt.figure(figsize=size, layout="constrained")
    is_alone = "body" not in panels or not (columns or has_history)
    parts = iter(drawn.subfigures(1, 1 if is_alone else 2, squeeze=False,
                                  width_ratios=[1.0] if is_alone else [1.0, max(1, len(columns)) * 0.6])[0])
    if "body" in panels:
        part = next(parts)
        body = part_of(case, field, scale)
        shape = (2, 1) if not body.is_tall and size[1] > BROAD * size[0] * (1.0 if is_alone else 0.45) else (1, 2)
        draw_solid(list(part.subplots(*shape, squeeze=False).ravel()), body)
    if columns or has_history:
        part = next(parts)
        # One set has its maps above each other, several have a row each.
        rows = [[(one, name) for name in columns] for one in maps] if columns else []
        rows = [[one] for one in rows[0]] if len(rows) == 1 else rows
        grid = part.add_gridspec(len(rows) + has_history, max(map(len, rows), default=1),
                                 height_ratios=[1.0] * len(rows) + [LOW] * has_history)
        for i, row in enumerate(rows):
            for j, (one, name) in enumerate(row):
                draw_contact_map(part.add_subplot(grid[i, j]), one, name)
        if has_history:
            draw_history(part.add_subplot(grid[-1, :]), case)
    return drawn


def draw_line(panels: list[tuple[str, Axes]], case: Case, shown: list[Stretch], label: str) -> None:
    """Panels of the contact line, pairs of name and axes, above each other with one abscissa."""
    for name, axes in panels:
        LINE_PANELS[name](axes, case, shown)
    for _, axes in panels[:-1]:
        axes.sharex(panels[-1][1])
        axes.tick_params(labelbottom=False)
    if panels:
        panels[-1][1].set_xlabel(label)


def draw_sweep(case: Case, size: Sequence[float], field: Optional[str]) -> tuple[Figure, str]:
    """A figure of a sweep, and its title: curves over one quantity, or a map of each column over two."""
    study = study_of(case, field)
    if not study.is_map:
        drawn, axes = plt.subplots(figsize=size, layout="constrained")
        draw_curves(axes, study)
        return drawn, study.title
    drawn, axes = plt.subplots(1, len(study.columns), figsize=size, layout="constrained", sharey=True, squeeze=False)
    maps = [draw_map(axis, study, column) for axis, column in zip(axes[0], study.columns)]
    axes[0, 0].set(ylabel=quantity(study.quantities[0]))
    drawn.colorbar(maps[-1], ax=axes).set_label(case.unit(dimension_of(study.columns[-1])))
    return drawn, study.title


def draw_reduced(case: Case, size: Sequence[float]) -> Figure:
    """A figure of a reduced problem: the forces of its contacts, and the residuals."""
    drawn, (above, below) = plt.subplots(2, 1, figsize=size, layout="constrained")
    draw_forces(above, case)
    draw_history(below, case)
    return drawn


def figure(case: Union[Case, str, os.PathLike[str]], panels: Optional[Sequence[str]] = None,
           field: Optional[str] = None, *, scale: Optional[float] = None, abscissa: Optional[str] = None,
           size: Optional[tuple[float, float]] = None) -> matplotlib.figure.Figure:
    """The figure of a case, which may be given by the path of its files.

    The panels are some of PANELS, the field is one of `draw_body.fields(case.mesh)` or a column of a sweep, the scale
    magnifies displacements and gaps, the abscissa is 's', 'x' or 'y', the size is in mm.
    """
    case = Case(case) if isinstance(case, (str, os.PathLike)) else case
    unused = {"scale": scale, "abscissa": abscissa, "panels": panels} if case.kind != "body" else {}
    if case.kind == "reduced":
        unused["field"] = field
    for name, value in unused.items():
        if value is not None:
            raise CaseFault(f"{case.path}: {name} is not for a {case.kind.replace('reduced', 'reduced problem')}")
    kind = case.kind
    if kind == "sweep" and (field or sum(quantity["values"] > 1 for quantity in case.summary["quantities"]) < 2):
        kind = "curve"
    inches = [length / INCH for length in size or SIZES[kind]]
    with plt.rc_context(STYLE):
        if case.kind == "sweep":
            drawn, title = draw_sweep(case, inches, field)
        elif case.kind == "reduced":
            drawn, title = draw_reduced(case, inches), case.heading
        else:
            title = case.heading
            if case.is_solid:
                if abscissa is not None:
                    raise CaseFault(f"{case.path}: abscissa is not for a solid")
                every = ("body", "stress", "slip", "history") if len(case.line.points) else ("body",)
                drawn = draw_solid_panels(case, panels or every, inches, field, scale)
                drawn.suptitle(plain(title))
                return drawn
            # Without contact points there are no iterations to show.
            every = PANELS if len(case.line.points) else tuple(BODY_PANELS)
            drawn = draw_panels(case, panels or every, inches, field or FIELD, scale, abscissa or "s")
            title = case.heading
        drawn.suptitle(plain(title))
    return drawn


def figure_of_steps(case: Union[Case, str, os.PathLike[str]], loop: Optional[Sequence[str]] = None, *,
                     size: Optional[tuple[float, float]] = None) -> matplotlib.figure.Figure:
    """The figure of a load history: a loop of two columns of NAME.history.csv, the zones over the pseudo-time, and the
    dissipation or the worn depth along the contact line."""
    case = Case(case) if isinstance(case, (str, os.PathLike)) else case
    if not case.has_steps:
        raise CaseFault(f"{case.path}: a loop is only for a load history that has steps")
    with plt.rc_context(STYLE):
        drawn, axes = plt.subplots(1, 3, figsize=[length / INCH for length in size or SIZES["steps"]],
                                   layout="constrained", width_ratios=[1.1, 1.3, 1])
        draw_loop(axes[0], case, loop)
        draw_zones(axes[1], case)
        draw_wear_or_dissipation(axes[2], case)
        drawn.suptitle(plain(case.heading))
    return drawn


def words_of(allowed: Sequence[str]) -> Callable[[str], list[str]]:
    """A reader of words that are separated by commas."""
    def read(text: str) -> list[str]:
        words = [word.strip() for word in text.split(",")]
        for word in words:
            if word not in allowed:
                raise argparse.ArgumentTypeError(f"'{word}' is none of {', '.join(allowed)}")
        return words
    return read


def size_of(text: str) -> tuple[float, float]:
    """Reads a size, WIDTHxHEIGHT."""
    try:
        width, height = map(float, text.lower().split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT in mm, found '{text}'") from None
    if not (20 <= width <= 2000 and 20 <= height <= 2000):
        raise argparse.ArgumentTypeError(f"expected 20 to 2000 mm, found '{text}'")
    return width, height


def factor_of(text: str) -> float:
    """Reads a magnification."""
    try:
        factor = float(text)
    except ValueError:
        factor = -1.0
    if not 0.0 <= factor < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number of at least 0, found '{text}'")
    return factor


def parser() -> Parser:
    """The options of the command."""
    options = Parser(prog="amontons-plot", description=__doc__)
    options.add_argument("case", nargs="+", metavar="CASE",
                         help="a folder of cases, any file of a case, or the path of its files without their endings")
    options.add_argument("--field", metavar="NAME",
                         help=f"field that colors the body: an array of NAME.vtu, of vectors and tensors with its "
                         f"component, as in nodal_stress_xy or displacement_x (default: {FIELD}, of a solid "
                         f"{NODAL_FIELD}); of a sweep a column of NAME.sweep.csv (default: the zones)")
    options.add_argument("--scale", type=factor_of, metavar="FACTOR",
                         help="magnification of displacements and gaps (default: a round number that shows them)")
    options.add_argument("--format", type=words_of(FORMATS), default=["png", "svg"], metavar="WORD,...",
                         help=f"files to write: {', '.join(FORMATS)} (default: png,svg)")
    options.add_argument("--size", type=size_of, metavar="WxH",
                         help="width and height in mm, as in 160x110; text has 8 points in any size")
    options.add_argument("--abscissa", choices=ABSCISSAS, help="of the contact line: its length s (default), x or y")
    options.add_argument("--loop", nargs=2, metavar=("X", "Y"),
                         help="of a load history: draw the column Y of NAME.history.csv over X (default: the first "
                         "probe, worn depth, preload, torque or tangential force, over the number that turns back "
                         "most often or changes last)")
    options.add_argument("--panels", type=words_of(PANELS), metavar="WORD,...",
                         help=f"parts of the figure: {', '.join(PANELS)} (default: all)")
    return options


def save(drawn: Any, stem: str, endings: Sequence[str]) -> None:
    """Writes a figure and says so."""
    with plt.rc_context(STYLE):
        for ending in endings:
            drawn.savefig(f"{stem}.{ending}")
            print(f"{stem}.{ending}")
    plt.close(drawn)


def main(arguments: Sequence[str]) -> int:
    """Draws the cases that the arguments name. Returns the exit status."""
    matplotlib.use("Agg")
    options = parser().parse_args(arguments)
    try:
        for path in find_cases(options.case):
            case = Case(path)
            if not case.has_state:
                print(f"plot: {path}: {case.summary['outcome'].replace('_', ' ')}, nothing to draw", file=sys.stderr)
                continue
            drawn = figure(case, options.panels, options.field, scale=options.scale, abscissa=options.abscissa,
                           size=options.size)
            save(drawn, path, options.format)
            if case.has_steps or options.loop:
                save(figure_of_steps(case, options.loop, size=options.size), f"{path}.steps", options.format)
    except OSError as error:
        sys.exit(f"plot: {error.filename}: {error.strerror}")
    except ValueError as error:
        sys.exit(f"plot: {error}")
    return 0
