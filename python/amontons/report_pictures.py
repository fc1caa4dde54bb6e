"""The pictures of a case in a report: SVG elements of the page, small and quick enough for hundreds of cases."""
from __future__ import annotations

import html
import re
from collections.abc import Iterator

import numpy as np

from amontons.cases import Case, dimension_of
from amontons.draw_body import FIELD, Field, draw_scene, draw_zone, magnification, magnification_at, moved_field
from amontons.draw_line import (LINE_PANELS, Stretch, abscissa_label, closed_part, closed_zone, draw_history,
                                has_detail, points_of, stretches)
from amontons.draw_solid import (QUANTITIES, Map, bar_label, colored, draw_map_axes, draw_slip_arrows,
                                 draw_status_labels, draw_view, map_image, maps_of, part_of, quantity_limits)
from amontons.draw_steps import draw_loop, draw_wear_or_dissipation, draw_zones
from amontons.draw_sweep import draw_curves, draw_forces, draw_map, quantity, study_of
from amontons.raster import cell_image, color_numbers, palette
from amontons.svg_axes import SvgAxes, legend

WIDTH = 4.6  # inch, so that text of 8 points can be read at the width of a phone
POINTS = 72  # in an inch
# Margins over the size of a picture; heights of the axes of the contact line over each other and the room between.
BODY = {"left": 0.12, "right": 0.82, "bottom": 0.2, "top": 0.93}
DETAIL = {"left": 0.12, "right": 0.97, "bottom": 0.12, "top": 0.9}
LINE = {"left": 0.17, "right": 0.98, "bottom": 0.12, "top": 0.94}
ALONE = {"left": 0.17, "right": 0.97, "bottom": 0.15, "top": 0.91}
HISTORY = {"left": 0.17, "right": 0.97, "bottom": 0.22, "top": 0.88}
SIDE = {"left": 0.02, "right": 0.8}
MAP = {"left": 0.15, "right": 0.78}
COARSE = 0.75
HIGHEST = 3.0  # inch, of a map
HEIGHTS, ROOM = (1.4, 1.0, 1.0), 0.25


def pictures_of(case: Case, name: str) -> tuple[list[str], str]:
    """The pictures of a case, and a small one for the table; the name is unique in the page."""
    label = html.escape(case.heading, quote=True)
    if case.kind == "body":
        small, *pictures = (_solid if case.is_solid else _body)(case, name, label)
        return pictures, small
    if case.kind == "sweep":
        pictures = list(_sweep(case, name, label))
        return pictures, _thumbnail(pictures[-1])
    axes, = _axes(2.6, (1.0,), **ALONE)
    draw_forces(axes, case)
    forces = _plot(axes, 2.6, f"{name}s", f"{label}: forces")
    return [forces, _residuals(case, name, label)], _thumbnail(forces)


def _sweep(case: Case, name: str, label: str) -> Iterator[str]:
    """The pictures of a sweep: curves, or a map of each column."""
    study, height = study_of(case), 2.8
    if not study.is_map:
        axes, = _axes(height, (1.0,), **ALONE)
        draw_curves(axes, study)
        yield _plot(axes, height, f"{name}s", f"{label}: sweep")
        return
    for number, column in enumerate(study.columns):
        axes, = _axes(height, (1.0,), **BODY)
        draw_map(axes, study, column)
        axes.set(ylabel=quantity(study.quantities[0]))
        unit = case.unit(dimension_of(column))
        yield _plot(axes, height, f"{name}s{number}", f"{label}: map of {axes.words['title']}",
                    axes.bar(f"{name}b{number}", study.limits, unit, None))


def _body(case: Case, name: str, label: str) -> Iterator[str]:
    """The small picture of a body, and the others."""
    sets = stretches(case.line)
    shown = closed_part(case.line.point_data["status"] > 1, sets) if sets else sets
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
        yield from _steps(case, name, label)
    if not case.summary["converged"]:
        yield _residuals(case, name, label)


def _steps(case: Case, name: str, label: str) -> Iterator[str]:
    """The pictures of a load history."""
    for number, draw in enumerate((draw_loop, draw_zones, draw_wear_or_dissipation)):
        axes, = _axes(2.8, (1.0,), **ALONE)
        draw(axes, case)
        yield _plot(axes, 2.8, f"{name}t{number}", f"{label}: load history")


def _solid(case: Case, name: str, label: str) -> Iterator[str]:
    """The small picture of a solid, and the others: both its sides, and maps of its contact faces."""
    part = part_of(case)
    wide, high = np.ptp(part.window(part.views[0]), axis=0)
    height = min(WIDTH * (SIDE["right"] - SIDE["left"]) * high / wide, HIGHEST) + 0.35
    for number in (0, 1):
        axes, = _axes(height, (1.0,), bottom=0.05 / height, top=1.0 - 0.3 / height, **SIDE)
        view, window = draw_view(axes, part, number)
        image, small = axes.image(f"{name}b{number}i", colored(part, view, window, _coarse(axes)))
        if number == 0:
            yield small
        yield _picture(f"{name}b{number}", f"{label}: body", height, image, axes.lines(f"{name}b{number}c"),
                       axes.title(), axes.bar(f"{name}b{number}b", part.limits, part.label, part.uniform))
    for number, one in enumerate(maps_of(case)):
        for panel in ("stress", "slip"):
            yield _map(one, panel, f"{name}{panel[:2]}{number}", label)
    if case.has_steps:
        yield from _steps(case, name, label)
    if not case.summary["converged"]:
        yield _residuals(case, name, label)


def _coarse(axes: SvgAxes) -> tuple[int, int]:
    """The size of an image whose edges are smooth, and which needs not be as fine as others."""
    width, height = (int(COARSE * count) for count in axes.size_of_image())
    return width, height


def _map(one: Map, panel: str, name: str, label: str) -> str:
    """The picture of a map."""
    wide, high = np.ptp(one.window, axis=0) if one.is_equal else (1.0, 0.6)
    height = min(WIDTH * (MAP["right"] - MAP["left"]) * high / wide, HIGHEST) + 0.8
    axes, = _axes(height, (1.0,), left=MAP["left"], right=MAP["right"], bottom=0.5 / height, top=1.0 - 0.3 / height)
    draw_map_axes(axes, one, panel)
    quantity_of = QUANTITIES[panel]
    image, _ = axes.image(f"{name}i", map_image(one, quantity_of, _coarse(axes)))
    if panel == "slip":
        draw_slip_arrows(axes, one)
        draw_status_labels(axes, one)
        beside = legend(axes.artists, axes.right + 8, axes.top + 6, 1)
    else:
        beside = axes.bar(f"{name}b", quantity_limits(one, quantity_of), bar_label(one, quantity_of), None)
    return _picture(name, f"{label}: {one.title}", height, image, axes.lines(f"{name}c"), axes.frame(), beside)


def _residuals(case: Case, name: str, label: str) -> str:
    """The picture of the residuals."""
    axes, = _axes(2.0, (1.0,), **HISTORY)
    draw_history(axes, case)
    return _plot(axes, 2.0, f"{name}h", f"{label}: residuals")


def _plot(axes: SvgAxes, height: float, name: str, label: str, *others: str) -> str:
    """The picture of axes with their cells, lines and legend, and others."""
    image = axes.image_of_cells(f"{name}i")[:1] if axes.cells else ()
    return _picture(name, label, height, *image, axes.lines(f"{name}c"), axes.frame(),
                    legend(axes.artists, axes.right, axes.top - 7, 4, is_right=True), *others)


def _thumbnail(picture: str) -> str:
    """A small view of a picture: of its image, if it has one, else of the whole."""
    image = re.search(r'<image id="(\w+)" x="([^"]*)" y="([^"]*)" width="([^"]*)" height="([^"]*)"', picture)
    whole = re.match(r'<svg id="(\w+)" viewBox="([^"]*)"', picture)
    assert whole is not None
    name, box = (image[1], " ".join(image.groups()[1:])) if image else whole.groups()
    return f'<svg class="thumb" viewBox="{box}" aria-hidden="true"><use href="#{name}"/></svg>'


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
