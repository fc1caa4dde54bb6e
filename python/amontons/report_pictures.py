"""The pictures of a case in a report: SVG elements of the page, small enough for hundreds of cases."""
import html

import matplotlib.pyplot as plt

from amontons import plot
from amontons.draw_body import draw_body, draw_detail
from amontons.draw_line import abscissa_label, closed_part, draw_history, points_of, stretches
from amontons.draw_steps import draw_steps
from amontons.draw_sweep import draw_reduced, draw_sweep
from amontons.inline_svg import STYLE, inline_svg, thumbnail

WIDTH = 4.6  # inch, so that text of 8 points can be read at the width of a phone
# Margins: to find them from the texts takes as long as to draw.
BODY = {"left": 0.1, "right": 0.82, "bottom": 0.2, "top": 0.93}
DETAIL = {"left": 0.12, "right": 0.97, "bottom": 0.12, "top": 0.9}
LINE = {"left": 0.17, "right": 0.98, "bottom": 0.12, "top": 0.94, "hspace": 0.22}
HISTORY = {"left": 0.14, "right": 0.98, "bottom": 0.22, "top": 0.88}


def pictures_of(case, name):
    """The pictures of a case, and a small one for the table; the name is unique in the page."""
    with plt.rc_context(STYLE):
        figures = list({"sweep": _sweep, "reduced": _reduced, "body": _body}[case.kind](case))
        label = html.escape(case.heading, quote=True)
        pictures = [inline_svg(figure, f"{name}{key}", f"{label}: {words}") for key, words, figure in figures]
    pictures[0], small = thumbnail(pictures[0], f"{name}{figures[0][0]}")
    return pictures, small


def _body(case):
    """The figures of a body: key, words and figure of each."""
    sets = stretches(case.line)
    shown = closed_part(case.line, sets) if sets else sets
    figure, axes = _axes(3.8, BODY)
    draw_body(axes, case, plot.FIELD, has_lines=False)
    yield "b", "body", _as_image(figure, axes)
    if sets:
        figure, axes = plt.subplots(3, 1, figsize=(WIDTH, 3.8), height_ratios=[1.4, 1, 1], gridspec_kw=LINE)
        plot.draw_line(list(zip(plot.LINE_PANELS, axes)), case, shown, abscissa_label(case, "s", shown, sets))
        yield "l", "contact line", figure
    if plot.has_detail(case, sets, shown):
        figure, axes = _axes(2.4, DETAIL)
        draw_detail(axes, case, plot.FIELD, points_of(shown), has_lines=False)
        yield "d", "closed zone", _as_image(figure, axes)
    if case.is_history and sets:
        yield "t", "load history", draw_steps(case, (2 * WIDTH, 3.0))
    if not case.summary["converged"]:
        figure, axes = _axes(2.0, HISTORY)
        draw_history(axes, case)
        yield "h", "residuals", figure


def _sweep(case):
    """The figure of a sweep."""
    yield "s", "sweep", draw_sweep(case, (2 * WIDTH, 3.4))[0]


def _reduced(case):
    """The figure of a reduced problem."""
    yield "r", "forces", draw_reduced(case, (WIDTH, 4.0))[0]


def _axes(height, margins):
    """A figure with one pair of axes."""
    return plt.subplots(figsize=(WIDTH, height), gridspec_kw=margins)


def _as_image(figure, axes):
    """Makes one image of all that is drawn in a pair of axes; its frame and texts stay lines and texts."""
    for artist in axes.collections:
        artist.set_rasterized(False)
    axes.set_axisbelow(False)
    axes.set_rasterization_zorder(2.4)
    return figure
