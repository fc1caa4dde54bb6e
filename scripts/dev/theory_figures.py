#!/usr/bin/env python3
"""Draws two figures of doc/theory.md into doc/images: ends.svg, the functions of multipliers at ends of slave and
master, and loose.svg, which loads friction cones can balance. Usage: theory_figures.py

Standard library only. Coordinates are those of the drawing, y downward.
"""
from math import cos, hypot, pi, sin
from pathlib import Path

IMAGES = Path(__file__).resolve().parents[2]/"doc"/"images"
BODY, MASTER, LINE, FORCE, FUNCTION, SUPPORT = "#dbe7f3", "#e9e4d8", "#333333", "#b3261e", "#1f6fb2", "#666666"


def polygon(points, fill, stroke=LINE, opacity=1.0):
    """A filled polygon."""
    places = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polygon points="{places}" fill="{fill}" fill-opacity="{opacity}" stroke="{stroke}"/>'


def line(points, stroke=LINE, width=1.0, dash=""):
    """A line through points."""
    places = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dashes = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<polyline points="{places}" fill="none" stroke="{stroke}" stroke-width="{width}"{dashes}/>'


def arrow(start, end, stroke=FORCE, width=2.0):
    """An arrow with its head at the end."""
    (x0, y0), (x1, y1) = start, end
    length = hypot(x1 - x0, y1 - y0)
    along, across = ((x1 - x0)/length, (y1 - y0)/length), ((y0 - y1)/length, (x1 - x0)/length)
    foot = (x1 - 8*along[0], y1 - 8*along[1])
    head = [(x1, y1), *((foot[0] + side*across[0], foot[1] + side*across[1]) for side in (-3.5, 3.5))]
    return line([start, foot], stroke, width) + polygon(head, stroke, stroke)


def text(place, words, size=12, anchor="middle", fill=LINE, style="normal"):
    """A line of text; `style` is that of the font."""
    return (f'<text x="{place[0]:.1f}" y="{place[1]:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{fill}" '
            f'font-style="{style}">{words}</text>')


def dots(points):
    """Nodes."""
    return "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{LINE}"/>' for x, y in points)


def roller(place):
    """A support that holds a node to its left, drawn beside it."""
    x, y = place
    return polygon([(x, y), (x - 12, y - 7), (x - 12, y + 7)], "white", SUPPORT) + line(
        [(x - 15, y - 11), (x - 15, y + 11)], SUPPORT, 2)


def page(width, height, parts):
    """The document."""
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            f'font-family="sans-serif">\n<rect width="{width}" height="{height}" fill="white"/>\n'
            + "\n".join(parts) + "\n</svg>\n")


def end_panel(origin, title, nodes, covered, functions, force, words):
    """A slave on its master: nodes of the slave, what the master covers, functions as (points, name, its place), the
    force of the last multiplier as (place, name), and words below. Lengths are in sides of the slave."""
    x0, y0 = origin
    side, rise, depth = 70.0, 46.0, 30.0

    def at(place, height=0.0):
        return x0 + side*place, y0 - rise*height

    first, last = nodes[0], nodes[-1]
    parts = [text((x0 + side*(first + last)/2, y0 - rise - 54), title, 13)]
    parts.append(polygon([at(first), at(last), (at(last)[0], y0 - depth), (at(first)[0], y0 - depth)], BODY, "none"))
    parts.append(polygon([at(covered[0]), at(covered[1]), (at(covered[1])[0], y0 + depth),
                          (at(covered[0])[0], y0 + depth)], MASTER, LINE))
    for k, (points, name, place) in enumerate(functions):
        color = FUNCTION if k == 0 else SUPPORT
        parts.append(line([(x, y - 4) for x, y in (at(*point) for point in points)], color, 2.0))
        parts.append(text((at(place)[0], at(place, 1.0)[1] - 10), name, 13, fill=color, style="italic"))
    parts += [line([at(first), at(last)], LINE, 2.0), dots(at(node) for node in nodes)]
    x, y = at(force[0])
    parts += [arrow((x, y + depth + 34), (x, y + 3)),
              text((x, y + depth + 48), force[1], 13, fill=FORCE, style="italic")]
    parts += [text((x0 + side*(first + last)/2, y0 + depth + 68 + 16*k), row, 12) for k, row in enumerate(words)]
    return parts


def ends():
    """The functions of the last multipliers at three kinds of ends."""
    parts = end_panel(
        (60, 130), "a support holds the corner", [0, 1, 2, 3], (-0.5, 3.4),
        [([(0, 1), (1, 1), (2, 0)], "η₁", 0.5), ([(1, 0), (2, 1), (3, 0)], "η₂", 2)], (2/3, "λ₁"),
        ["The corner 0 has no multiplier.", "Its neighbor's function is 1 on the side;",
         "the force acts at 2h/3 from the end."])
    parts.append(roller((58, 118)))
    parts += end_panel(
        (370, 130), "the master ends within a side", [0, 1, 2, 3], (-0.5, 2.55),
        [([(1, 0), (2.55, 1)], "η", 2.45), ([(0, 0), (1, 1), (2.55, 0)], "", 1)], (2.55, "λ"),
        ["The functions are dual to the hats", "on the part that the master covers:",
         "the last force acts at its end."])
    parts += [text((370 + 70*k, 150), name, 12, style="italic") for k, name in ((1, "q"), (2, "p"))]
    parts += end_panel(
        (745, 130), "it covers less than 28 %", [0, 1], (-0.7, 0.22),
        [([(0, 1), (0.22, 1)], "1", 0.11)], (0.11, "λ"),
        ["The corner beyond has no multiplier.", "The function of the other one is 1 on",
         "the part; the force acts in its middle."])
    parts += [text((95, 120), "slave", 12), text((230, 150), "master", 12)]
    return page(900, 268, parts)


def cone(place, friction, length, opacity=0.35):
    """The friction cone of a point on a floor, with its two edges."""
    x, y = place
    edges = [(x + sign*friction*length, y - length) for sign in (-1, 1)]
    return [polygon([place, *edges], FORCE, "none", opacity), *(line([place, edge], FORCE, 1.5) for edge in edges)]


def block(origin, title, load, at, words, friction=0.3):
    """A block on a floor with the cones of its corners and a load at a place; words below."""
    x, y = origin
    width, height = 120.0, 80.0
    corners = [(x, y), (x + width, y)]
    parts = [text((x + width/2, y - height - 72), title, 13),
             polygon([(x, y), (x + width, y), (x + width, y - height), (x, y - height)], BODY),
             polygon([(x - 40, y), (x + width + 40, y), (x + width + 40, y + 12), (x - 40, y + 12)], MASTER, "none"),
             line([(x - 40, y), (x + width + 40, y)])]
    for corner in corners:
        parts += cone(corner, friction, 62)
    start = (at[0] - load[0], at[1] - load[1])
    parts.append(arrow(start, at, FUNCTION))
    parts += [text((x + width/2, y + 34 + 16*k), row, 12) for k, row in enumerate(words)]
    return parts


def loose():
    """A block on a rough floor under three loads: one that the cones balance, and two that they cannot."""
    width, height = 120.0, 80.0
    parts = []
    for x, title, load, at, words in (
            (60, "balanced", (12, 60), (60 + width/2, 180 - height),
             ["A sum of the edges of both cones,", "factors at least 0, balances the load."]),
            (320, "no equilibrium: it slides", (42, 60), (320 + width/2, 180 - height),
             ["No sum of edges leans so far.", "What is left over is the motion",
              "that nothing opposes: along the floor."]),
            (580, "no equilibrium: it tips", (0, 60), (580 + width + 18, 180 - height),
             ["The force passes beside the corner.", "What is left over is the turn", "about this corner."])):
        parts += block((x, 180), title, load, at, words)
    parts.append(line([(580 + width, 180 - height), (580 + width + 26, 180 - height)], LINE, 5))
    parts.append(motion((320 + width + 14, 150)))
    parts.append(turn((580 + width, 180), 46))
    return page(780, 260, parts)


def motion(place):
    """A free motion along the floor, dashed."""
    x, y = place
    return line([(x, y), (x + 24, y)], LINE, 1.5, "4 3") + arrow((x + 22, y), (x + 36, y), LINE, 1.5)


def turn(center, radius):
    """A free turn about a corner, dashed."""
    arc = [(center[0] + radius*cos(a), center[1] - radius*sin(a)) for a in (pi*(0.36 - 0.045*k) for k in range(7))]
    return line(arc[:-1], LINE, 1.5, "4 3") + arrow(arc[-2], arc[-1], LINE, 1.5)


if __name__ == "__main__":
    (IMAGES/"ends.svg").write_text(ends(), encoding="utf-8")
    (IMAGES/"loose.svg").write_text(loose(), encoding="utf-8")
