"""The pictures of a case in a report: SVG elements of the page, small and quick enough for hundreds of cases."""
from __future__ import annotations

import functools
import html
from collections.abc import Iterator
from typing import Optional

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from matplotlib.ticker import AutoLocator, ScalarFormatter

from amontons import plot
from amontons.cases import Case
from amontons.draw_body import draw_detail, draw_scene
from amontons.draw_line import Stretch, abscissa_label, closed_part, closed_zone, draw_history, points_of, stretches
from amontons.draw_steps import draw_steps
from amontons.draw_sweep import draw_reduced, draw_sweep
from amontons.inline_svg import STYLE, inline_svg, thumbnail
from amontons.svg_axes import Box, legend

WIDTH = 4.6  # inch, so that text of 8 points can be read at the width of a phone
POINTS = 72  # in an inch
# Margins: to find them from the texts takes as long as to draw.
BODY = {"left": 0.12, "right": 0.82, "bottom": 0.2, "top": 0.93}
DETAIL = {"left": 0.12, "right": 0.97, "bottom": 0.12, "top": 0.9}
LINE = {"left": 0.17, "right": 0.98, "bottom": 0.12, "top": 0.94, "hspace": 0.22}
HISTORY = {"left": 0.14, "right": 0.98, "bottom": 0.22, "top": 0.88}


def pictures_of(case: Case, name: str) -> tuple[list[str], str]:
    """The pictures of a case, and a small one for the table; the name is unique in the page."""
    label = html.escape(case.heading, quote=True)
    with plt.rc_context(STYLE):
        if case.kind == "body":
            small, *pictures = _body(case, name, label)
            return pictures, small
        figure = draw_sweep(case, (2 * WIDTH, 3.4))[0] if case.kind == "sweep" else draw_reduced(case, (WIDTH, 4.0))[0]
        picture, small = thumbnail(inline_svg(figure, f"{name}s", f"{label}: {case.kind}"), f"{name}s")
    return [picture], small


def _body(case: Case, name: str, label: str) -> Iterator[str]:
    """The small picture of a body, and the others."""
    sets = stretches(case.line)
    shown = closed_part(case.line, sets) if sets else sets
    sheet = _sheet((3.8,), **BODY)
    field = draw_scene(sheet.axes[0], case, plot.FIELD, has_lines=False)
    box = Box(sheet.axes[0], sheet.size)
    entries = list(zip(*sheet.axes[0].get_legend_handles_labels()))
    texts = box.frame() + box.bar(f"{name}bb", *field) + legend(entries, box.left + 10, box.bottom + 37, 2)
    image, small = box.image(f"{name}bi")
    yield small
    yield sheet.picture(f"{name}b", f"{label}: body", image + texts)
    if sets:
        yield _line(case, shown, abscissa_label(case, "s", shown, sets), f"{name}l", f"{label}: contact line")
    zone = closed_zone(case.line, sets) if sets else sets
    if plot.has_detail(case, sets, zone):
        sheet = _sheet((2.4,), **DETAIL)
        draw_detail(sheet.axes[0], case, plot.FIELD, points_of(zone), has_lines=False)
        box = Box(sheet.axes[0], sheet.size)
        texts = box.frame()
        yield sheet.picture(f"{name}d", f"{label}: closed zone", box.image(f"{name}di")[0] + texts)
    if case.has_steps and sets:
        yield inline_svg(draw_steps(case, (2 * WIDTH, 3.0)), f"{name}t", f"{label}: load history")
    if not case.summary["converged"]:
        figure, axes = plt.subplots(figsize=(WIDTH, 2.0), gridspec_kw=HISTORY)
        draw_history(axes, case)
        yield inline_svg(figure, f"{name}h", f"{label}: residuals")


def _line(case: Case, shown: list[Stretch], abscissa: str, name: str, label: str) -> str:
    """The picture of the contact line."""
    sheet = _sheet((1.4, 1.0, 1.0), height=3.8, **LINE)
    for draw, axes in zip(plot.LINE_PANELS.values(), sheet.axes):
        draw(axes, case, shown)
    sheet.axes[-1].set_xlabel(abscissa)
    parts = ""
    for number, axes in enumerate(sheet.axes):
        axes.set_xlim(sheet.axes[0].get_xlim())
        box = Box(axes, sheet.size)
        parts += box.lines(f"{name}{number}") + box.frame(has_labels=axes is sheet.axes[-1])
        if number == 0:
            entries = list(zip(*axes.get_legend_handles_labels()))
            parts += legend(entries, box.right + 8, box.top - 7, len(entries), is_right=True)
    return sheet.picture(name, label, parts)


class _Sheet:
    """Axes above each other that one case after the other draws into: to make them takes longer than to draw."""

    def __init__(self, heights: tuple[float, ...], height: float, margins: dict[str, float]) -> None:
        """The heights are those of the axes over each other, the height is that of the whole, in inches."""
        figure = Figure(figsize=(WIDTH, height), dpi=STYLE["savefig.dpi"])
        self.axes = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights, gridspec_kw=margins)[:, 0]
        self.places = [axes.get_position() for axes in self.axes]
        self.size = (WIDTH * POINTS, height * POINTS)

    def clear(self) -> None:
        """Leaves nothing of the case before."""
        for axes, place in zip(self.axes, self.places):
            for artist in [*axes.lines, *axes.collections]:
                artist.remove()
            axes.legend_ = None
            axes.relim()
            axes.set_autoscale_on(True)
            axes.set(aspect="auto", title="", xlabel="", ylabel="")
            axes.set_position(place)
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_major_locator(AutoLocator())
                axis.set_major_formatter(ScalarFormatter())

    def picture(self, name: str, label: str, content: str) -> str:
        """Content as an element of a page."""
        return (f'<svg id="{name}" viewBox="0 0 {self.size[0]:g} {self.size[1]:g}" role="img" aria-label="{label}" '
                f'font-family="sans-serif">{content}</svg>')


@functools.lru_cache(maxsize=None)
def _sheet_once(heights: tuple[float, ...], height: float, margins: tuple[tuple[str, float], ...]) -> _Sheet:
    """The sheet of some sizes; there is one of each in a process."""
    return _Sheet(heights, height, dict(margins))


def _sheet(heights: tuple[float, ...], height: Optional[float] = None, **margins: float) -> _Sheet:
    """A sheet that is clear; the height of the whole is the sum of those of the axes where it is not given."""
    sheet = _sheet_once(heights, height or sum(heights), tuple(margins.items()))
    sheet.clear()
    return sheet
