"""The surfaces of rigid obstacles: as lines, the free side on the left, and in space; doc/decks.md explains the keys of
`&contact`."""
from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np

from amontons.grid import Array

N_POINTS = 801  # of a curved line: no corner is seen at the size of a page
MOST_STROKES = 100000
N_LINES = 17  # of a surface in space, along the longer side
BEYOND = 0.12  # of the extent of a contact set, how far a surface in space goes on
ASIDE = 0.25   # of the extent of a contact set, how far beside it triangles are drawn
FALL = 0.12    # of the extent, from the apex of a curved surface to its ends
ROUND = 1.4    # rad: the most of a sphere or cylinder that is drawn to each side


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


@dataclass(frozen=True)
class Surface:
    """The obstacle of a `&contact` of a solid, near some points."""
    kind: str
    radius: float  # of curvature, positive where it bulges to the body; not a number of a plane
    apex: Array    # a point of the surface, of a sphere or cylinder the nearest to the points
    frame: Array   # directions there: two tangents, of a cylinder across and along its axis, and the normal (3, 3)
    is_around: bool  # the points are all around a cylinder

    @classmethod
    def near(cls, contact: dict[str, Any], points: Array) -> Surface:
        """That of a `&contact`, whose deck leaves out the vectors of its default."""
        kind, radius = contact["obstacle"], float(contact.get("radius", np.nan))
        if kind not in ("plane", "sphere", "cylinder", "paraboloid"):
            raise ValueError(f"obstacle '{kind}' cannot be drawn")
        apex, normal = (np.array(contact.get(key, default), dtype=float)
                        for key, default in (("point", (0.0, 0.0, 0.0)), ("normal", (0.0, 0.0, 1.0))))
        normal = normal / np.linalg.norm(normal)
        axis = np.array(contact.get("axis", np.eye(3)[np.argsort(np.abs(normal), kind="stable")[1]]), dtype=float)
        is_around = False
        if kind in ("sphere", "cylinder"):
            center = apex - radius * normal
            way = points - center
            if kind == "cylinder":
                way = way - np.outer(way @ axis, axis) / (axis @ axis)
            middle = way.mean(axis=0)
            is_around = kind == "cylinder" and np.linalg.norm(middle) < 0.5 * np.linalg.norm(way, axis=1).mean()
            if np.linalg.norm(middle) > 0.0 and not is_around:
                normal = np.copysign(1.0, radius) * middle / np.linalg.norm(middle)
            apex = center + radius * normal
        along = axis - (axis @ normal) * normal
        along = along / np.linalg.norm(along)
        return cls(kind, radius, apex, np.stack([np.cross(along, normal), along, normal]), is_around)

    def heights(self, points: Array) -> Array:
        """How far points are outside of it, along its normal or, of a paraboloid, along its axis (n)."""
        s, t, h = ((points - self.apex) @ self.frame.T).T
        if self.kind == "plane":
            return h
        if self.kind == "paraboloid":
            return h + (s**2 + t**2) / (2 * self.radius)
        far = np.hypot(s, h + self.radius) if self.kind == "cylinder" else np.sqrt(s**2 + t**2 + (h + self.radius)**2)
        return np.sign(self.radius) * (far - abs(self.radius))

    def mesh(self, points: Array) -> tuple[Array, Array]:
        """Places on it beside the points, and somewhat beyond them, and the quadrilaterals between (n, 4)."""
        flat = ((points - self.apex) @ self.frame.T)[:, :2]
        low, high = flat.min(axis=0), flat.max(axis=0)
        margin = BEYOND * (high - low).max()
        low, high = low - margin, high + margin
        if self.kind != "plane":
            # No farther than where it falls by a part of the extent.
            most = np.sqrt(2 * FALL * abs(self.radius) * (high - low).max())
            curved = slice(0, 1) if self.kind == "cylinder" else slice(0, 2)
            low[curved], high[curved] = np.maximum(low[curved], -most), np.minimum(high[curved], most)
        if self.is_around:
            low[0], high[0] = -np.pi * abs(self.radius), np.pi * abs(self.radius)
        counts = np.maximum(np.ceil(N_LINES * (high - low) / (high - low).max()).astype(int), 3)
        s, t = np.meshgrid(*(np.linspace(*ends) for ends in zip(low, high, counts)), indexing="ij")
        s, t = s.ravel(), t.ravel()
        if self.kind == "plane":
            h = 0.0 * s
        elif self.kind == "paraboloid":
            h = -(s**2 + t**2) / (2 * self.radius)
        else:
            way = np.abs(s) if self.kind == "cylinder" else np.hypot(s, t)
            angle = np.minimum(way / abs(self.radius), np.pi if self.is_around else ROUND)
            scale = abs(self.radius) * np.sin(angle) / np.maximum(way, 1e-300)
            s, t = scale * s, t if self.kind == "cylinder" else scale * t
            h = self.radius * (np.cos(angle) - 1.0)
        number = np.arange(counts[0] * counts[1]).reshape(counts)
        quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
        return self.apex + np.stack([s, t, h], axis=1) @ self.frame, quads.reshape(-1, 4)


def triangles_near(contact: dict[str, Any], points: Array) -> tuple[Array, Array]:
    """The triangles of the surface of a `&contact` beside some points, or as far from these as they extend: places
    (n, 3) and the corners of the triangles, by these."""
    corners = read_stl(contact["file"]) + np.array(contact.get("point", (0.0, 0.0, 0.0)), dtype=float)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = ASIDE * (high - low).max()
    near = corners[((corners.max(axis=1) > low - margin) & (corners.min(axis=1) < high + margin)).all(axis=1)]
    return near.reshape(-1, 3), np.arange(3 * len(near)).reshape(-1, 3)


def read_stl(path: Union[str, os.PathLike[str]]) -> Array:
    """The corners of the triangles of an STL file, binary or text (n, 3, 3)."""
    data = Path(path).read_bytes()
    count = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + 50 * count:
        rows = np.frombuffer(data, np.dtype([("numbers", "<f4", 12), ("attribute", "<u2")]), count, 84)
        return rows["numbers"][:, 3:].reshape(-1, 3, 3).astype(float)
    words = re.findall(rb"(?i)\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", data)
    if not words or len(words) % 3:
        raise ValueError(f"{path}: not an STL file")
    return np.array(words).astype(float).reshape(-1, 3, 3)


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
