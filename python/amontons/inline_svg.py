"""Makes figures part of a page: SVG without what a page does not need, in the page's own text color."""
from __future__ import annotations

import io
import re

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

STYLE = {"font.size": 8, "axes.titlesize": "medium", "axes.linewidth": 0.5, "lines.linewidth": 1.0,
         "xtick.major.width": 0.5, "ytick.major.width": 0.5, "legend.fontsize": "small", "svg.fonttype": "none",
         "figure.facecolor": "none", "axes.facecolor": "none", "savefig.dpi": 150}
_DIGITS = re.compile(r"(\.\d\d)\d+")
_NUMBERS = re.compile(r' (?:d|x|y|transform|points)="[^"]*"')
_IMAGE = re.compile(r"<image ([^>]*?)/?>", re.DOTALL)


def inline_svg(figure: Figure, name: str, label: str) -> str:
    """A figure as an element of a page. The name, unique in the page, begins the identifiers that it needs."""
    content = io.StringIO()
    with plt.rc_context({"svg.hashsalt": name}):
        figure.savefig(content, format="svg", transparent=True)
    plt.close(figure)
    text = content.getvalue()
    box = _box_of(text)
    text = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", text[text.index("<svg"):],
                  flags=re.DOTALL)
    text = text[text.index(">") + 1:text.rindex("</svg>")]
    used = set(re.findall(r"#(\w+)", text))
    text = re.sub(r' id="([^"]*)"', lambda found: f' id="{name}{found[1]}"' if found[1] in used else "", text)
    text = re.sub(r'(href="|url\()#', rf"\1#{name}", text).replace("xlink:href", "href")
    text = _NUMBERS.sub(lambda found: _DIGITS.sub(r"\1", found[0]), text)
    text = re.sub(r"#000000", "currentColor", text)
    text = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font: \1px sans-serif", text)
    text = re.sub(r">\s+<", "><", text).strip()
    text = re.sub(r"<g></g>", "", text)
    return f'<svg id="{name}" viewBox="{box}" role="img" aria-label="{label}">{text}</svg>'


def _box_of(svg: str) -> str:
    """The part of the plane that a figure shows, as its attribute says it."""
    return svg.partition('viewBox="')[2].partition('"')[0]


def thumbnail(svg: str, name: str) -> tuple[str, str]:
    """A small view of an inlined figure: of its first raster image if it has one, else of the whole. Returns the
    figure, whose image then has an identifier, and the view."""
    image = _IMAGE.search(svg)
    if image is None:
        return svg, f'<svg class="thumb" viewBox="{_box_of(svg)}" aria-hidden="true"><use href="#{name}"/></svg>'
    numbers = {key: float(value) for key, value in re.findall(r'\b(x|y|width|height)="([-\d.]+)"', image[1])}
    # The image is drawn upside down: scale(1 -1) translate(0 -height).
    top = -numbers.get("y", 0.0)
    box = f'{numbers.get("x", 0.0):g} {top:g} {numbers["width"]:g} {numbers["height"]:g}'
    svg = svg.replace("<image ", f'<image id="{name}i" ', 1)
    return svg, f'<svg class="thumb" viewBox="{box}" aria-hidden="true"><use href="#{name}i"/></svg>'
