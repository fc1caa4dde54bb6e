"""The surfaces of rigid obstacles as lines, the free side on the left; doc/decks.md explains the keys of `&contact`."""
from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any, Union

import numpy as np

from amontons.grid import Array

N_POINTS = 801  # of a curved line: no corner is seen at the size of a page
MOST_STROKES = 100000


def surface(contact: dict[str, Any], window: Array) -> Array:
    """The surface of the obstacle of a `&contact`, as far as it may be seen in a window (lower left and upper right
    corner); points (n, 2)."""
    # A deck that states no vector leaves out those of its default.
    point, normal = (np.array(contact.get(key, default), dtype=float)
                     for key, default in (("point", (0.0, 0.0)), ("normal", (0.0, 1.0))))
    normal /= np.hypot(*normal)
    corners = np.array([[x, y] for x in window[:, 0] for y in window[:, 1]])
    reach = np.hypot(*(corners - point).T).max()
    kind, radius = contact["obstacle"], contact.get("radius", np.nan)
    if kind == "circle":
        angle = np.linspace(-1, 1, N_POINTS) * min(np.pi, 2 * reach / abs(radius))
        s, h = abs(radius) * np.sin(angle), radius * (np.cos(angle) - 1)
    elif kind == "parabola":
        s = np.linspace(-reach, reach, N_POINTS)
        h = -(s**2) / (2 * radius)
    elif kind == "polyline":
        s, h = read_line(contact["line"]).T
    elif kind == "plane":
        s, h = np.array([-reach, reach]), np.zeros(2)
    else:
        raise ValueError(f"obstacle '{kind}' cannot be drawn")
    return point + np.outer(s, [normal[1], -normal[0]]) + np.outer(h, normal)


def read_line(path: Union[str, os.PathLike[str]]) -> Array:
    """The points of a polyline (n, 2): two numbers a line; comments and one line of headings are passed over."""
    lines = [line for line in Path(path).read_text(encoding="utf-8").splitlines()
             if line.strip() and not line.lstrip().startswith("#")]
    words = [re.split(r"[\s,;]+", line.strip()) for line in lines]
    try:
        float(words[0][0])
    except ValueError:
        del words[0]
    return np.array([[float(word.lower().replace("d", "e")) for word in pair[:2]] for pair in words])


def distance(points: Array, line: Array) -> float:
    """The largest distance of some points from a line."""
    if not len(points):
        return 0.0
    start, way = line[:-1], np.diff(line, axis=0)
    share = ((points[:, None] - start) * way).sum(axis=2) / np.maximum((way**2).sum(axis=1), 1e-300)
    nearest = start + np.clip(share, 0.0, 1.0)[:, :, None] * way
    return float(np.hypot(*np.moveaxis(points[:, None] - nearest, 2, 0)).min(axis=1).max())


def hatching(line: Array, window: Array, spacing: float) -> Array:
    """Short strokes on the solid side of a line, at equal distances, where they begin in a window; (n, 2, 2)."""
    steps = np.hypot(*np.diff(line, axis=0).T)
    line, steps = line[np.concatenate([[True], steps > 0])], steps[steps > 0]
    way = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.arange(spacing / 2, min(way[-1], MOST_STROKES * spacing), spacing)
    starts = np.column_stack([np.interp(at, way, x) for x in line.T])
    tangents = (np.diff(line, axis=0) / steps[:, None])[np.clip(np.searchsorted(way, at) - 1, 0, len(steps) - 1)]
    ends = starts + spacing * (np.column_stack([tangents[:, 1], -tangents[:, 0]]) - tangents)
    inside = ((starts >= window[0]) & (starts <= window[1])).all(axis=1)
    strokes: Array = np.stack([starts, ends], axis=1)[inside]
    return strokes
