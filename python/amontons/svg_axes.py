"""Writes axes of Matplotlib as SVG without drawing them: to lay out their ticks and texts takes Matplotlib a hundred
times as long as to make their lines. What is under the lines is one image."""
from __future__ import annotations

import base64
import html
import io
import re
from collections.abc import Iterator
from typing import Any, Optional

import numpy as np
from matplotlib import colors
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from PIL import Image
from matplotlib.axes import Axes

from amontons.grid import Array

TICK, GAP = 3.5, 3.0     # length of a tick and the room behind it, in points
SMALL, MEDIUM = 7, 8     # sizes of texts, in points
WIDE = 0.6               # of a character of usual width, over the size of its text
SAMPLE = 14              # length of the sample of a line in a legend, in points
# Relative paths around a place, of a radius and a diameter.
MARKERS = {"o": "m-{r} 0a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0", "s": "m-{r}-{r}h{d}v{d}h-{d}z",
           ">": "m-{r}-{r}l{d} {r}-{d} {r}z", "<": "m{r}-{r}l-{d} {r} {d} {r}z"}
RAISED = str.maketrans("0123456789-−", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻")


def short(number: float) -> str:
    """A coordinate."""
    return f"{number:.2f}".rstrip("0").rstrip(".") if np.isfinite(number) else "0"


def plain(text: str) -> str:
    """What Matplotlib would set as a formula, and dollars that stand for themselves."""
    text = re.sub(r"10\^\{([^}]*)\}", lambda found: "10" + found[1].translate(RAISED), text)
    text = re.sub(r"\\mathdefault\{([^{}]*)\}", r"\1", text)
    return text.replace(r"\times", "×").replace(r"\$", "\0").replace("$", "").replace("\0", "$")


def color_of(color: Any) -> str:
    """A color of the page: black becomes that of its text."""
    found = colors.to_hex(color)
    return "currentColor" if found == "#000000" else found


def text_at(x: float, y: float, text: str, anchor: str = "middle", size: int = MEDIUM,
            turn: Optional[int] = None) -> str:
    """A text; the place is the middle, the start or the end of its base line."""
    turned = f' transform="rotate({turn} {short(x)} {short(y)})"' if turn else ""
    anchored = f' text-anchor="{anchor}"' if anchor != "start" else ""
    return (f'<text x="{short(x)}" y="{short(y)}" font-size="{size}"{anchored}{turned}>'
            f"{html.escape(plain(text), quote=False)}</text>")


def line_through(x: Any, y: Any) -> str:
    """The path of a line, interrupted where a number is missing."""
    path, pen = "", "M"
    for one, other in zip(x, y):
        if not (np.isfinite(one) and np.isfinite(other)):
            pen = "M"
            continue
        path += f"{pen}{short(one)} {short(other)}"
        pen = "L"
    return path


class Box:
    """Axes with their place in a picture, in points from its upper left corner."""

    def __init__(self, axes: Axes, size: tuple[float, float]) -> None:
        """Takes the axes as they are; the size of the picture is in points."""
        axes.apply_aspect()
        place = axes.get_position()
        self.axes = axes
        self.left, self.right = place.x0 * size[0], place.x1 * size[0]
        self.top, self.bottom = (1 - place.y1) * size[1], (1 - place.y0) * size[1]
        self.xlim, self.ylim = axes.get_xlim(), axes.get_ylim()

    def x(self, values: Any) -> Any:
        """Abscissas in the picture."""
        return self.left + (np.asarray(values, float) - self.xlim[0]) / np.ptp(self.xlim) * (self.right - self.left)

    def y(self, values: Any) -> Any:
        """Ordinates in the picture."""
        return self.bottom - (np.asarray(values, float) - self.ylim[0]) / np.ptp(self.ylim) * (self.bottom - self.top)

    def frame(self, has_labels: bool = True) -> str:
        """Frame, ticks, their labels and the texts of the axes; the labels of the abscissa may be left out."""
        parts = [f'<path d="M{short(self.left)} {short(self.top)}H{short(self.right)}V{short(self.bottom)}'
                 f'H{short(self.left)}z{self._ticks()}" fill="none" stroke="currentColor" stroke-width="0.5"/>']
        ordinates, widest = self._labels(self.axes.yaxis, self.ylim), 0.0
        for value, text in ordinates:
            parts.append(text_at(self.left - TICK - GAP, self.y(value) + 3, text, "end"))
            widest = max(widest, WIDE * MEDIUM * len(plain(text)))
        if has_labels:
            for value, text in self._labels(self.axes.xaxis, self.xlim):
                parts.append(text_at(self.x(value), self.bottom + TICK + GAP + 6, text))
        parts += self._texts(widest, has_labels)
        return "".join(parts)

    def _labels(self, axis: Any, limits: tuple[float, float]) -> list[tuple[float, str]]:
        """Pairs of value and text of the ticks of an axis."""
        values = [value for value in axis.get_majorticklocs() if limits[0] <= value <= limits[1]]
        return list(zip(values, axis.get_major_formatter().format_ticks(values)))

    def _ticks(self) -> str:
        """The path of all ticks."""
        path = ""
        for value, _ in self._labels(self.axes.xaxis, self.xlim):
            path += f"M{short(self.x(value))} {short(self.bottom)}v{TICK}"
        for value, _ in self._labels(self.axes.yaxis, self.ylim):
            path += f"M{short(self.left)} {short(self.y(value))}h-{TICK}"
        return path

    def _texts(self, widest: float, has_labels: bool) -> Iterator[str]:
        """Title, labels and the factors of the ticks."""
        middle, center = (self.left + self.right) / 2, (self.top + self.bottom) / 2
        if self.axes.get_title():
            yield text_at(middle, self.top - 6, self.axes.get_title())
        if has_labels and self.axes.get_xlabel():
            yield text_at(middle, self.bottom + TICK + GAP + 18, self.axes.get_xlabel())
        if self.axes.get_ylabel():
            x = self.left - TICK - GAP - widest - 5
            yield text_at(max(x, MEDIUM), center, self.axes.get_ylabel(), turn=-90)
        factor = self.axes.yaxis.get_major_formatter().get_offset()
        if factor:
            yield text_at(self.left, self.top - 3, factor, "start")
        factor = self.axes.xaxis.get_major_formatter().get_offset()
        if factor and has_labels:
            yield text_at(self.right, self.bottom + TICK + GAP + 18, factor, "end")

    def lines(self, name: str) -> str:
        """The lines and markers of the axes, cut off at their frame, which gets the name, unique in the page, for an
        identifier."""
        parts = [self._line(line) for line in self.axes.lines]
        return (f'<clipPath id="{name}"><rect x="{short(self.left)}" y="{short(self.top)}" '
                f'width="{short(self.right - self.left)}" height="{short(self.bottom - self.top)}"/></clipPath>'
                f'<g clip-path="url(#{name})" fill="none">{"".join(parts)}</g>')

    def _line(self, line: Any) -> str:
        """A line with its markers."""
        x, y = np.asarray(line.get_xdata(orig=False), float), np.asarray(line.get_ydata(orig=False), float)
        # A line across the axes has its abscissas in parts of their width.
        is_across = line.get_transform() != self.axes.transData
        x = self.left + x * (self.right - self.left) if is_across else self.x(x)
        y = self.y(y)
        parts, color = "", color_of(line.get_color())
        if line.get_linestyle() != "None" and len(x) > 1:
            parts += (f'<path d="{line_through(x, y)}" stroke="{color}" '
                      f'stroke-width="{line.get_linewidth():g}"{dashes_of(line)}/>')
        every = line.get_markevery() or 1
        if line.get_marker() in MARKERS and len(x):
            parts += markers(x[::every], y[::every], line)
        return parts

    def image(self, name: str) -> tuple[str, str]:
        """All that the axes show inside their frame, as an image with an identifier, and a small view of it."""
        figure, axes = self.axes.figure, self.axes
        axes.set_axis_off()
        axes.set_title("", y=1.0)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        axes.set_axis_on()
        scale = figure.dpi / 72
        rows = slice(int(np.floor(self.top * scale)), int(np.ceil(self.bottom * scale)))
        columns = slice(int(np.floor(self.left * scale)), int(np.ceil(self.right * scale)))
        pixels = np.asarray(canvas.buffer_rgba())[rows, columns]
        x, y, width, height = (short(number / scale) for number in (columns.start, rows.start, *pixels.shape[1::-1]))
        return (f'<image id="{name}" x="{x}" y="{y}" width="{width}" height="{height}" '
                f'href="data:image/png;base64,{encoded(pixels)}"/>',
                f'<svg class="thumb" viewBox="{x} {y} {width} {height}" aria-hidden="true"><use href="#{name}"/></svg>')

    def bar(self, name: str, drawn: Any, label: str, uniform: Optional[float]) -> str:
        """The bar of a field, at the right of the axes; of a uniform one it has its one value. The name becomes the
        identifier of its colors."""
        x, width = self.right + 0.03 * (self.right - self.left), 0.035 * (self.right - self.left)
        drawn.autoscale_None()
        low, high = drawn.get_clim()
        stops = "".join(f'<stop offset="{part:.3g}" stop-color="{colors.to_hex(drawn.cmap(part))}"/>'
                        for part in np.linspace(0, 1, 17))
        parts = [f'<linearGradient id="{name}" x1="0" y1="1" x2="0" y2="0">{stops}</linearGradient>'
                 f'<rect x="{short(x)}" y="{short(self.top)}" width="{short(width)}" '
                 f'height="{short(self.bottom - self.top)}" fill="url(#{name})" stroke="currentColor" '
                 'stroke-width="0.4"/>']
        ticks, factor = bar_ticks(low, high, uniform, max(2, int((self.bottom - self.top) / (3 * MEDIUM))))
        path, widest = "", 0.0
        for value, text in ticks:
            y = self.bottom - (value - low) / (high - low) * (self.bottom - self.top)
            path += f"M{short(x + width)} {short(y)}h{TICK}"
            parts.append(text_at(x + width + TICK + GAP, y + 3, text, "start"))
            widest = max(widest, WIDE * MEDIUM * len(plain(text)))
        parts.append(f'<path d="{path}" stroke="currentColor" stroke-width="0.5"/>')
        if factor:
            parts.append(text_at(x, self.top - 6, factor, "start"))
        at = x + width + TICK + GAP + widest + 8
        parts.append(text_at(at, (self.top + self.bottom) / 2, label if uniform is None else label + ", uniform",
                             turn=-90))
        return "".join(parts)


def bar_ticks(low: float, high: float, uniform: Optional[float], most: int) -> tuple[list[tuple[float, str]], str]:
    """Pairs of value and text of the ticks of a bar, and the factor of the texts."""
    if uniform is not None:
        return [(uniform, f"{uniform:.4g}")], ""
    values = [value for value in MaxNLocator(most).tick_values(low, high) if low <= value <= high]
    formatter = ScalarFormatter(useMathText=True)
    formatter.set_powerlimits((-3, 4))
    formatter.create_dummy_axis()
    formatter.axis.set_view_interval(low, high)
    return list(zip(values, formatter.format_ticks(values))), formatter.get_offset()


def legend(line_entries: list[tuple[Any, str]], x: Any, y: Any, columns: int, is_right: bool = False) -> str:
    """Samples of lines with their labels, in columns; the place is the upper left corner, or the upper right one."""
    if not line_entries:
        return ""
    widths = [SAMPLE + 4 + WIDE * SMALL * len(label) + 8 for _, label in line_entries]
    rows = -(-len(widths) // columns)
    spans = [max(widths[first:first + rows]) for first in range(0, len(widths), rows)]
    left = x - sum(spans) if is_right else x
    parts = ""
    for number, (line, label) in enumerate(line_entries):
        at = left + sum(spans[:number // rows])
        height = y + 10 * (number % rows)
        if line.get_linestyle() != "None":
            parts += (f'<path d="M{short(at)} {short(height)}h{SAMPLE}" stroke="{color_of(line.get_color())}" '
                      f'stroke-width="{line.get_linewidth():g}"{dashes_of(line)}/>')
        if line.get_marker() in MARKERS:
            parts += markers([at + SAMPLE / 2], [height], line)
        parts += text_at(at + SAMPLE + 4, height + 2.5, label, "start", SMALL)
    return parts


def dashes_of(line: Any) -> str:
    """The attribute of a dashed line."""
    style = line.get_linestyle()
    if style == "-":
        return ""
    numbers = {":": (1, 1.65), "--": (6, 1)}[style]
    return ' stroke-dasharray="' + " ".join(f"{number * line.get_linewidth():g}" for number in numbers) + '"'


def markers(x: Any, y: Any, line: Any) -> str:
    """The markers of a line, as one path."""
    radius = (line.get_markersize() + line.get_markeredgewidth()) / 2
    form = MARKERS[line.get_marker()].format(r=f"{radius:g}", d=f"{2 * radius:g}")
    places = "".join(f"M{short(one)} {short(other)}{form}" for one, other in zip(x, y)
                     if np.isfinite(one) and np.isfinite(other))
    return f'<path d="{places}" fill="{color_of(line.get_color())}"/>'


def encoded(pixels: Array) -> str:
    """Pixels as the text of a PNG."""
    content = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(content, "png")
    return base64.b64encode(content.getvalue()).decode("ascii")
