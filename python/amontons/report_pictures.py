"""The pictures of a case in a report: SVG elements of the page, small and quick enough for hundreds of cases."""
from __future__ import annotations

import html
from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np

from amontons.cases import Case
from amontons.draw_body import FIELD, Field, draw_scene, draw_zone, magnification, magnification_at, moved_field
from amontons.draw_line import (LINE_PANELS, Stretch, abscissa_label, closed_part, closed_zone, draw_history,
                                has_detail, points_of, stretches)
from amontons.draw_steps import draw_steps
from amontons.draw_sweep import draw_reduced, draw_sweep
from amontons.inline_svg import STYLE, inline_svg, thumbnail
from amontons.raster import cell_image, color_numbers, palette
from amontons.svg_axes import SvgAxes, legend

WIDTH = 4.6  # inch, so that text of 8 points can be read at the width of a phone
POINTS = 72  # in an inch
# Margins over the size of a picture; heights of the axes of the contact line over each other and the room between.
BODY = {"left": 0.12, "right": 0.82, "bottom": 0.2, "top": 0.93}
DETAIL = {"left": 0.12, "right": 0.97, "bottom": 0.12, "top": 0.9}
LINE = {"left": 0.17, "right": 0.98, "bottom": 0.12, "top": 0.94}
HISTORY = {"left": 0.14, "right": 0.98, "bottom": 0.22, "top": 0.88}
HEIGHTS, ROOM = (1.4, 1.0, 1.0), 0.25


def pictures_of(case: Case, name: str) -> tuple[list[str], str]:
    """The pictures of a case, and a small one for the table; the name is unique in the page."""
    label = html.escape(case.heading, quote=True)
    if case.kind == "body":
        small, *pictures = _body(case, name, label)
        return pictures, small
    with plt.rc_context(STYLE):
        figure = draw_sweep(case, (2 * WIDTH, 3.4))[0] if case.kind == "sweep" else draw_reduced(case, (WIDTH, 4.0))[0]
        picture, small = thumbnail(inline_svg(figure, f"{name}s", f"{label}: {case.kind}"), f"{name}s")
    return [picture], small


def _body(case: Case, name: str, label: str) -> Iterator[str]:
    """The small picture of a body, and the others."""
    sets = stretches(case.line)
    shown = closed_part(case.line, sets) if sets else sets
    height, factor = 3.8, magnification(case)
    axes, = _axes(height, (1.0,), **BODY)
    draw_scene(axes, case, factor)
    field = moved_field(case, factor, FIELD)
    image, small = _image(axes, f"{name}bi", field)
    yield small
    bar = axes.bar(f"{name}bb", field.limits, field.label, field.uniform)
    yield _picture(f"{name}b", f"{label}: body", height, image, axes.lines(f"{name}bc"), axes.frame(), bar,
                   legend(axes.artists, axes.left + 10, axes.bottom + 37, 2))
    if sets:
        yield _line(case, shown, abscissa_label(case, "s", shown, sets), f"{name}l", f"{label}: contact line")
    zone = closed_zone(case.line, sets) if sets else sets
    if has_detail(case, sets, zone):
        height, factor = 2.4, magnification_at(case, points_of(zone))
        axes, = _axes(height, (1.0,), **DETAIL)
        draw_zone(axes, case, points_of(zone), factor)
        image, _ = _image(axes, f"{name}di", moved_field(case, factor, FIELD))
        yield _picture(f"{name}d", f"{label}: closed zone", height, image, axes.lines(f"{name}dc"), axes.frame())
    if case.has_steps and sets:
        with plt.rc_context(STYLE):
            yield inline_svg(draw_steps(case, (2 * WIDTH, 3.0)), f"{name}t", f"{label}: load history")
    if not case.summary["converged"]:
        with plt.rc_context(STYLE):
            figure, residuals = plt.subplots(figsize=(WIDTH, 2.0), gridspec_kw=HISTORY)
            draw_history(residuals, case)
            yield inline_svg(figure, f"{name}h", f"{label}: residuals")


def _line(case: Case, shown: list[Stretch], abscissa: str, name: str, label: str) -> str:
    """The picture of the contact line."""
    height, parts = 3.8, []
    column = _axes(height, HEIGHTS, **LINE)
    for number, (draw, axes) in enumerate(zip(LINE_PANELS.values(), column)):
        draw(axes, case, shown)
        axes.set(xlim=column[0].xlim, xlabel=abscissa)
        parts += [axes.lines(f"{name}{number}"), axes.frame(has_labels=axes is column[-1])]
    top = column[0]
    return _picture(name, label, height, *parts, legend(top.artists, top.right + 8, top.top - 7, 3, is_right=True))


def _image(axes: SvgAxes, name: str, field: Field) -> tuple[str, str]:
    """A field on cells as an image that fills axes, and a small view of it."""
    colors = color_numbers(field.values, *field.limits)
    first, polygons = 0, []
    for outlines in field.outlines:
        polygons.append((outlines, colors[first:first + len(outlines)]))
        first += len(outlines)
    window = np.column_stack([axes.xlim, axes.ylim])
    return axes.image(name, cell_image(polygons, window, axes.size_of_image()), palette("cividis"))


def _axes(height: float, heights: tuple[float, ...], left: float, right: float, bottom: float,
          top: float) -> list[SvgAxes]:
    """Axes above each other in a picture, whose height is in inches."""
    scale = (top - bottom) / (sum(heights) + ROOM * (len(heights) - 1))
    found, low = [], top
    for one in heights:
        low, high = low - one * scale, low
        found.append(SvgAxes(left * WIDTH * POINTS, (1 - high) * height * POINTS, right * WIDTH * POINTS,
                             (1 - low) * height * POINTS))
        low -= ROOM * scale
    return found


def _picture(name: str, label: str, height: float, *parts: str) -> str:
    """Parts as an element of a page."""
    return (f'<svg id="{name}" viewBox="0 0 {WIDTH * POINTS:g} {height * POINTS:g}" role="img" aria-label="{label}" '
            f'font-family="sans-serif">{"".join(parts)}</svg>')
