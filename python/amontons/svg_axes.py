"""Axes that write SVG: what draws a case draws into them as into those of Matplotlib, whose methods of the same names
they have. To lay out and draw one figure takes Matplotlib a hundred times as long."""
from __future__ import annotations

import html
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Optional, Union

import numpy as np
from matplotlib.colors import Colormap
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from amontons.grid import Array
from amontons.raster import N_COLORS, color_numbers, palette, png_text

TICK, GAP = 3.5, 3.0     # length of a tick and the room behind it, in points
SMALL, MEDIUM = 7, 8     # sizes of texts, in points
WIDE = 0.6               # of a character of usual width, over the size of its text
SAMPLE = 14              # length of the sample of a line in a legend, in points
SEAM = 0.05              # of the range of all lines, on each side
MOST_TICKS, STEPS = 9, (1, 2, 2.5, 5, 10)
FINE = 150 / 72          # pixels of an image in a point
# Relative paths around a place, of a radius and a diameter. Discs and squares are the ends of a line without length.
MARKERS = {">": "m-{r}-{r}l{d} {r}-{d} {r}z", "<": "m{r}-{r}l-{d} {r} {d} {r}z"}
CAPS = {"o": "round", ".": "round", "s": "square"}
DASHES = {"-": (), ":": (1, 1.65), "--": (3.7, 1.6)}  # over the width of the line
RAISED = str.maketrans("0123456789-−", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻")


def short(number: float) -> str:
    """A coordinate."""
    return f"{number:.2f}".rstrip("0").rstrip(".") if np.isfinite(number) else "0"


def plain(text: str) -> str:
    """What Matplotlib would set as a formula, and dollars that stand for themselves."""
    text = re.sub(r"10\^\{([^}]*)\}", lambda found: "10" + found[1].translate(RAISED), text)
    text = re.sub(r"\\mathdefault\{([^{}]*)\}", r"\1", text)
    return text.replace(r"\times", "×").replace(r"\$", "\0").replace("$", "").replace("\0", "$")


def color_of(color: str) -> str:
    """A color of the page: black becomes that of its text."""
    return "currentColor" if color == "black" else color


def text_at(x: float, y: float, text: str, anchor: str = "middle", size: int = MEDIUM,
            turn: Optional[int] = None) -> str:
    """A text; the place is the middle, the start or the end of its base line."""
    turned = f' transform="rotate({turn} {short(x)} {short(y)})"' if turn else ""
    anchored = f' text-anchor="{anchor}"' if anchor != "start" else ""
    return (f'<text x="{short(x)}" y="{short(y)}" font-size="{size}"{anchored}{turned}>'
            f"{html.escape(plain(text), quote=False)}</text>")


def line_through(x: Array, y: Array) -> str:
    """The path of a line, interrupted where a number is missing."""
    path, pen = [], "M"
    for one, other, is_there in zip(x.tolist(), y.tolist(), (np.isfinite(x) & np.isfinite(y)).tolist()):
        if is_there:
            path.append(f"{pen}{one:.5g} {other:.5g}")
        pen = "L" if is_there else "M"
    return "".join(path)


@dataclass(frozen=True)
class Line:
    """A line with its markers."""
    x: Array
    y: Array
    color: str
    linestyle: Any
    linewidth: float
    marker: Optional[str]
    markersize: float
    markevery: int
    label: Optional[str]
    zorder: float
    is_across: bool  # the abscissas are parts of the width of the axes

    def drawn(self, x: Array, y: Array) -> str:
        """The line through places in the picture."""
        color, parts = color_of(self.color), ""
        if self.linestyle != "none" and len(x) > 1:
            parts = (f'<path d="{line_through(x, y)}" stroke="{color}" stroke-width="{self.linewidth:g}"'
                     f"{self._dashes()}/>")
        if not self.marker or not len(x):
            return parts
        x, y = x[::self.markevery], y[::self.markevery]
        is_there = np.isfinite(x) & np.isfinite(y)
        places = [f"M{one:.5g} {other:.5g}" for one, other in zip(x[is_there].tolist(), y[is_there].tolist())]
        radius = (self.markersize + 1.0) / (4 if self.marker == "." else 2)
        if self.marker in CAPS:
            return parts + (f'<path d="{"".join(place + "h0" for place in places)}" stroke="{color}" '
                            f'stroke-width="{2 * radius:g}" stroke-linecap="{CAPS[self.marker]}"/>')
        form = MARKERS[self.marker].format(r=f"{radius:g}", d=f"{2 * radius:g}")
        return parts + f'<path d="{"".join(place + form for place in places)}" fill="{color}"/>'

    def _dashes(self) -> str:
        """The attribute of a dashed line."""
        numbers = DASHES[self.linestyle] if isinstance(self.linestyle, str) else self.linestyle[1]
        text = " ".join(f"{number * self.linewidth:g}" for number in numbers)
        return f' stroke-dasharray="{text}"' if text else ""


@dataclass(frozen=True)
class Marks:
    """What is drawn at places, besides lines; see `Line`."""
    x: Array
    y: Array
    label: ClassVar[Optional[str]] = None
    zorder: ClassVar[float] = 2.0
    is_across: ClassVar[bool] = False


@dataclass(frozen=True)
class Arrows(Marks):
    """Arrows from places in directions of the picture."""
    across: Array  # in points
    up: Array
    color: str

    def drawn(self, x: Array, y: Array) -> str:
        """The arrows at places in the picture."""
        u, v = self.across, -self.up
        # The shaft, and from its end back on both sides.
        steps = np.stack([u, v, -0.3 * u - 0.15 * v, -0.3 * v + 0.15 * u, 0.3 * u + 0.15 * v, 0.3 * v - 0.15 * u,
                          -0.3 * u + 0.15 * v, -0.3 * v - 0.15 * u], axis=-1)
        path = "".join(f"M{one:.5g} {other:.5g}l" + " ".join(map(short, way))
                       for one, other, way in zip(x.tolist(), y.tolist(), steps.tolist()))
        return f'<path d="{path}" stroke="{color_of(self.color)}" stroke-width="0.9"/>' if path else ""


@dataclass(frozen=True)
class Text(Marks):
    """A text whose middle is at places."""
    text: str

    def drawn(self, x: Array, y: Array) -> str:
        """The text at places in the picture."""
        return "".join(text_at(one, other + 2.5, self.text, size=SMALL).replace("<text", '<text fill="currentColor"', 1)
                       for one, other in zip(x.tolist(), y.tolist()))


def ticks_between(limits: tuple[float, float], most: float, are_whole: bool = False) \
        -> tuple[list[tuple[float, str]], str]:
    """Pairs of value and text of ticks, as many as there is room for, and the factor of the texts."""
    locator = MaxNLocator(int(np.clip(most, 1, MOST_TICKS)), steps=STEPS, integer=are_whole,
                          min_n_ticks=1 if are_whole else 2)
    return labels_of(locator.tick_values(*limits).tolist(), limits)


def powers_between(limits: tuple[float, float], most: float) -> list[tuple[float, str]]:
    """Pairs of logarithm and text of ticks at powers of ten, as many as there is room for, between whole logarithms."""
    first, last = map(int, limits)
    step = int((last - first) // max(most, 1)) + 1
    return [(float(power), f"10^{{{power}}}") for power in range(first, last + 1, step)]


def range_of(values: list[Array]) -> tuple[float, float]:
    """The range that shows all numbers, with a seam."""
    numbers = np.concatenate(values or [np.zeros(0)])
    numbers = numbers[np.isfinite(numbers)]
    low, high = float(numbers.min(initial=np.inf)), float(numbers.max(initial=-np.inf))
    if not low < high:
        middle = low if len(numbers) else 0.0
        low, high = middle - (SEAM * abs(middle) or SEAM), middle + (SEAM * abs(middle) or SEAM)
    return low - SEAM * (high - low), high + SEAM * (high - low)


@dataclass(frozen=True)
class Cells:
    """A number in each cell between lines along both axes, as colors."""
    x: Array  # where the cells end along the abscissa (n + 1)
    y: Array  # where they end along the ordinate (m + 1)
    values: Array  # (m, n); where it is not a number there is no color
    cmap: Colormap
    limits: tuple[float, float]  # the values of the first and the last color


def labels_of(values: list[float], limits: tuple[float, float]) -> tuple[list[tuple[float, str]], str]:
    """Pairs of value and text of the ticks that are between limits, and the factor of the texts."""
    values = [value for value in values if limits[0] <= value <= limits[1]]
    formatter = ScalarFormatter(useMathText=True)
    formatter.set_powerlimits((-3, 4))
    formatter.create_dummy_axis()
    formatter.axis.set_view_interval(*limits)
    return list(zip(values, formatter.format_ticks(values))), formatter.get_offset()


class SvgAxes:
    """Axes in a picture, in points from its upper left corner."""

    def __init__(self, left: float, top: float, right: float, bottom: float) -> None:
        """The axes have this place, a part of it where their aspect is equal."""
        self.left, self.top, self.right, self.bottom = left, top, right, bottom
        self.artists: list[Union[Line, Arrows, Text]] = []
        self.cells: Optional[Cells] = None
        self.words = {"title": "", "xlabel": "", "ylabel": ""}
        self.yticks: Optional[list[float]] = None
        self.has_whole_abscissas = self.is_logarithmic = False
        self._xlim: Optional[tuple[float, float]] = None
        self._ylim: Optional[tuple[float, float]] = None

    def plot(self, x: Any, y: Any, *, color: str, linestyle: Any = "-", linewidth: float = 1.0,
             marker: Optional[str] = None, markersize: float = 6.0, markevery: int = 1, label: Optional[str] = None,
             zorder: float = 2.0, is_across: bool = False, **_: Any) -> None:
        """Adds a line."""
        self.artists.append(Line(np.asarray(x, float), np.asarray(y, float), color, linestyle, linewidth, marker,
                                 markersize, markevery, label, zorder, is_across))

    def quiver(self, x: Array, y: Array, u: Array, v: Array, *, color: str, scale: float, **_: Any) -> None:
        """Adds arrows from places; a direction of the length `scale` is an inch long."""
        self.artists.append(Arrows(x, y, 72 / scale * u, 72 / scale * v, color))

    def text(self, x: float, y: float, text: str, **_: Any) -> None:
        """Adds a text with its middle at a place."""
        self.artists.append(Text(np.array([x]), np.array([y]), text))

    def pcolormesh(self, x: Array, y: Array, values: Array, *, cmap: Colormap, vmin: float, vmax: float,
                   **_: Any) -> None:
        """Adds cells; the axes show them and nothing beside them."""
        self.cells = Cells(x, y, values, cmap, (vmin, vmax))
        self.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))

    def axhline(self, y: float, *, color: str, linewidth: float) -> None:
        """Adds a line across the axes."""
        self.plot([0.0, 1.0], [y, y], color=color, linewidth=linewidth, is_across=True)

    def set(self, *, xlim: Any = None, ylim: Any = None, aspect: str = "auto", **words: str) -> None:
        """Sets the range of the axes and their texts. With an equal aspect the axes become lower or narrower."""
        self.words.update(words)
        if xlim is not None:
            self._xlim = (float(xlim[0]), float(xlim[1]))
        if ylim is not None:
            self.set_ylim(*ylim)
        if aspect == "equal":
            width, height = self.right - self.left, self.bottom - self.top
            scale = min(width / np.ptp(self.xlim), height / np.ptp(self.ylim))
            across, down = (width - scale * np.ptp(self.xlim)) / 2, (height - scale * np.ptp(self.ylim)) / 2
            self.left, self.right, self.top, self.bottom = (self.left + across, self.right - across, self.top + down,
                                                            self.bottom - down)

    def set_ylim(self, low: float, high: float) -> None:
        """Sets the range of the ordinate."""
        self._ylim = (float(low), float(high))

    def set_yscale(self, name: str) -> None:
        """Makes the ordinate logarithmic, or linear."""
        self.is_logarithmic = name == "log"

    def set_yticks(self, values: list[float]) -> None:
        """Sets the ticks of the ordinate."""
        self.yticks = values

    def ticklabel_format(self, **_: Any) -> None:
        """Texts of ticks have the one form there is."""

    def legend(self, **_: Any) -> None:
        """Who writes the picture knows where there is room for a legend."""

    @property
    def xlim(self) -> tuple[float, float]:
        """The range of the abscissa: all lines, where none is set."""
        if self._xlim is not None:
            return self._xlim
        return range_of([line.x for line in self.artists if not line.is_across])

    @property
    def ylim(self) -> tuple[float, float]:
        """The range of the ordinate, or of its logarithm: all lines, where none is set."""
        if self._ylim is not None:
            return self._ylim
        low, high = range_of([self._scaled(line.y) for line in self.artists])
        return (float(np.floor(low)), float(np.ceil(high))) if self.is_logarithmic else (low, high)

    def _scaled(self, values: Any) -> Any:
        """Ordinates, or their logarithms."""
        return np.log10(values) if self.is_logarithmic else values

    def x(self, values: Any) -> Any:
        """Abscissas in the picture."""
        low, high = self.xlim
        return self.left + (values - low) / (high - low) * (self.right - self.left)

    def y(self, values: Any) -> Any:
        """Ordinates in the picture."""
        return self._y_of(self._scaled(values))

    def _y_of(self, values: Any) -> Any:
        """The places of ordinates, or of logarithms of them."""
        low, high = self.ylim
        return self.bottom - (values - low) / (high - low) * (self.bottom - self.top)

    def frame(self, has_labels: bool = True) -> str:
        """Frame, ticks, their labels and the texts of the axes; the labels of the abscissa may be left out."""
        abscissas, x_factor = ticks_between(self.xlim, (self.right - self.left) / (3 * MEDIUM),
                                            self.has_whole_abscissas)
        most = (self.bottom - self.top) / (2 * MEDIUM)
        if self.yticks is not None:
            ordinates, y_factor = labels_of(self.yticks, self.ylim)
        elif self.is_logarithmic:
            ordinates, y_factor = powers_between(self.ylim, most), ""
        else:
            ordinates, y_factor = ticks_between(self.ylim, most)
        strokes = "".join(f"M{short(self.x(value))} {short(self.bottom)}v{TICK}" for value, _ in abscissas) + \
            "".join(f"M{short(self.left)} {short(self._y_of(value))}h-{TICK}" for value, _ in ordinates)
        parts = [f'<path d="M{short(self.left)} {short(self.top)}H{short(self.right)}V{short(self.bottom)}'
                 f'H{short(self.left)}z{strokes}" fill="none" stroke="currentColor" stroke-width="0.5"/>']
        parts += [text_at(self.left - TICK - GAP, self._y_of(value) + 3, text, "end") for value, text in ordinates]
        middle, below = (self.left + self.right) / 2, self.bottom + TICK + GAP + 18
        if has_labels:
            parts += [text_at(self.x(value), self.bottom + TICK + GAP + 6, text) for value, text in abscissas]
            parts += [text_at(middle, below, self.words["xlabel"]), text_at(self.right, below, x_factor, "end")]
        widest = max((WIDE * MEDIUM * len(plain(text)) for _, text in ordinates), default=0.0)
        parts += [self.title(),
                  text_at(self.left, self.top - 3, y_factor, "start"),
                  text_at(max(self.left - TICK - GAP - widest - 5, MEDIUM), (self.top + self.bottom) / 2,
                          self.words["ylabel"], turn=-90)]
        return "".join(part for part in parts if not part.endswith("></text>"))

    def title(self) -> str:
        """The title alone."""
        return text_at((self.left + self.right) / 2, self.top - 6, self.words["title"])

    def lines(self, name: str) -> str:
        """The lines and markers of the axes, cut off at their frame, which gets the name, unique in the page, for an
        identifier."""
        width = self.right - self.left
        parts = [line.drawn(self.left + line.x * width if line.is_across else self.x(line.x), self.y(line.y))
                 for line in sorted(self.artists, key=lambda line: line.zorder)]
        return (f'<clipPath id="{name}"><rect x="{short(self.left)}" y="{short(self.top)}" '
                f'width="{short(width)}" height="{short(self.bottom - self.top)}"/></clipPath>'
                f'<g clip-path="url(#{name})" fill="none">{"".join(parts)}</g>')

    def size_of_image(self) -> tuple[int, int]:
        """Width and height of an image that fills the axes, in pixels."""
        return round((self.right - self.left) * FINE), round((self.bottom - self.top) * FINE)

    def image_of_cells(self, name: str) -> tuple[str, str]:
        """The cells as an image, and a small view of it."""
        assert self.cells is not None
        cells, n_colors = self.cells, min(self.cells.cmap.N, N_COLORS)
        colors = color_numbers(np.nan_to_num(cells.values), *cells.limits, n_colors)
        colors[~np.isfinite(cells.values)] = 0
        # The cell that the middle of each pixel is in; rows of pixels begin above.
        column, row = (np.searchsorted(ends, limits[0] + (np.arange(count) + 0.5) / count * np.ptp(limits), "right") - 1
                       for ends, limits, count in zip((cells.x, cells.y), (self.xlim, self.ylim), self.size_of_image()))
        return self.image(name, colors[np.ix_(row[::-1], column)],
                          cells.cmap(np.linspace(0.0, 1.0, n_colors), bytes=True)[:, :3])

    def image(self, name: str, pixels: Array, colors: Optional[Array] = None) -> tuple[str, str]:
        """An image that fills the axes, with an identifier, and a small view of it; see png_text."""
        x, y, width, height = (short(number) for number in (self.left, self.top, self.right - self.left,
                                                            self.bottom - self.top))
        return (f'<image id="{name}" x="{x}" y="{y}" width="{width}" height="{height}" preserveAspectRatio="none" '
                f'href="{png_text(pixels, colors)}"/>',
                f'<svg class="thumb" viewBox="{x} {y} {width} {height}" aria-hidden="true"><use href="#{name}"/></svg>')

    def bar(self, name: str, limits: tuple[float, float], label: str, uniform: Optional[float]) -> str:
        """The bar of a field between two values, at the right of the axes; of a uniform one it has its one value. The
        name becomes the identifier of its colors."""
        x, width = self.right + 0.03 * (self.right - self.left), 0.035 * (self.right - self.left)
        low, high = limits
        stops = "".join(f'<stop offset="{number / (N_COLORS - 1):.3g}" stop-color="#{bytes(color).hex()}"/>'
                        for number, color in list(enumerate(palette("cividis")))[::16])
        parts = [f'<linearGradient id="{name}" x1="0" y1="1" x2="0" y2="0">{stops}</linearGradient>'
                 f'<rect x="{short(x)}" y="{short(self.top)}" width="{short(width)}" '
                 f'height="{short(self.bottom - self.top)}" fill="url(#{name})" stroke="currentColor" '
                 'stroke-width="0.4"/>']
        ticks, factor = ([(uniform, f"{uniform:.4g}")], "") if uniform is not None else \
            ticks_between(limits, (self.bottom - self.top) / (3 * MEDIUM))
        path, widest = "", 0.0
        for value, text in ticks:
            y = self.bottom - (value - low) / (high - low) * (self.bottom - self.top)
            path += f"M{short(x + width)} {short(y)}h{TICK}"
            parts.append(text_at(x + width + TICK + GAP, y + 3, text, "start"))
            widest = max(widest, WIDE * MEDIUM * len(plain(text)))
        parts.append(f'<path d="{path}" stroke="currentColor" stroke-width="0.5"/>')
        if factor:
            parts.append(text_at(x, self.top - 6, factor, "start"))
        at = x + width + TICK + GAP + widest + 9
        parts.append(text_at(at, (self.top + self.bottom) / 2, label if uniform is None else label + ", uniform",
                             turn=-90))
        return "".join(parts)


def legend(lines: Iterable[Line], x: float, y: float, columns: int, is_right: bool = False) -> str:
    """Samples of the lines that have a label, in columns; the place is the upper left or the upper right corner."""
    labeled = [line for line in lines if line.label]
    if not labeled:
        return ""
    widths = [SAMPLE + 4 + WIDE * SMALL * len(line.label or "") + 8 for line in labeled]
    rows = -(-len(widths) // min(columns, len(widths)))
    spans = [max(widths[first:first + rows]) for first in range(0, len(widths), rows)]
    left, parts = x - sum(spans) if is_right else x, ""
    for number, line in enumerate(labeled):
        at, height = left + sum(spans[:number // rows]), y + 10 * (number % rows)
        ends = np.array([at, at + SAMPLE] if line.linestyle != "none" else [at + SAMPLE / 2])
        parts += line.drawn(ends, np.full(len(ends), height))
        parts += text_at(at + SAMPLE + 4, height + 2.5, line.label or "", "start", SMALL)
    return parts
