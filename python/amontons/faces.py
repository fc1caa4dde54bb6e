"""The faces of solids: those of the boundary, the triangles that fill them, and how they look from afar."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from amontons.grid import EDGES, FACES, Array, Grid
from amontons.raster import nearest, weights_of

# Shape functions of corners and of middle nodes in the middle of a face, by its number of nodes.
MIDDLE = {3: (1 / 3, 0.0), 4: (1 / 4, 0.0), 6: (-1 / 9, 4 / 9), 8: (-1 / 4, 1 / 2)}
RIDGE = np.cos(np.radians(30.0))  # of the angle between faces from which on their common edge is drawn
STEEP = 3.0  # pixels: a larger step of depth between two of them is an outline


@dataclass(frozen=True)
class Faces:
    """Some faces, seen from outside."""
    outlines: list[Array]  # nodes around the faces of one kind, middle ones between the corners (n_faces, n)
    cells: Array  # the cell that each face belongs to, all kinds in turn (n_faces)

    @cached_property
    def triangles(self) -> tuple[Array, Array]:
        """The triangles that fill the faces, and the face of each: the faces of three nodes, of others triangles from
        the middle to two nodes beside each other. Middles are numbered -1, -2, ... (n, 3)."""
        parts, faces, first = [], [], 0
        for outline in self.outlines:
            count, width = outline.shape
            face = np.arange(first, first + count)
            if width > 3:
                face = np.repeat(face, width)
                outline = np.column_stack([-1 - face, outline.ravel(), np.roll(outline, -1, axis=1).ravel()])
            parts.append(outline)
            faces.append(face)
            first += count
        return np.concatenate(parts), np.concatenate(faces)

    def middles(self, values: Array) -> Array:
        """The values in the middles of faces of what is known at nodes (n_faces, ...)."""
        found = []
        for outline in self.outlines:
            corner, between = MIDDLE[outline.shape[1]]
            if outline.shape[1] < 6:
                found.append(corner * values[outline].sum(axis=1))
            else:
                found.append(corner * values[outline[:, ::2]].sum(axis=1)
                             + between * values[outline[:, 1::2]].sum(axis=1))
        return np.concatenate(found)

    def at_corners(self, values: Array) -> Array:
        """What is known at nodes at the corners of the triangles (n, 3, ...)."""
        found: Array = np.concatenate([values, self.middles(values)[::-1]])[self.triangles[0]]
        return found


def boundary_faces(mesh: Grid) -> Faces:
    """The faces of a solid that belong to one cell alone."""
    owners, outlines, keys, first = [], [], [], 0
    for kind, nodes in mesh.cells:
        shape = kind.rstrip("0123456789")
        middle = {edge: len(mesh_corners(shape)) + i for i, edge in enumerate(EDGES.get(kind, []))}
        for corners in FACES[shape]:
            around = [node for one, other in zip(corners, corners[1:] + corners[:1])
                      for node in (one, *([middle[min(one, other), max(one, other)]] if middle else []))]
            # Two faces that have three corners in common are the same.
            low = np.sort(nodes[:, corners], axis=1)[:, :3].astype(np.int64)
            keys.append((low[:, 0] * len(mesh.points) + low[:, 1]) * len(mesh.points) + low[:, 2])
            outlines.append(nodes[:, around])
            owners.append(np.arange(first, first + len(nodes)))
        first += len(nodes)
    _, place, count = np.unique(np.concatenate(keys), return_index=True, return_counts=True)
    is_single = np.zeros(sum(map(len, keys)), dtype=bool)
    is_single[place[count == 1]] = True
    parts = np.split(is_single, np.cumsum([len(key) for key in keys])[:-1])
    found: dict[int, tuple[list[Array], list[Array]]] = {}
    for outline, owner, part in zip(outlines, owners, parts):
        of_kind = found.setdefault(outline.shape[1], ([], []))
        of_kind[0].append(outline[part])
        of_kind[1].append(owner[part])
    return Faces([np.concatenate(some) for some, _ in found.values()],
                 np.concatenate([cell for _, cells in found.values() for cell in cells]))


def mesh_corners(shape: str) -> list[int]:
    """The corners of a cell."""
    return sorted({corner for corners in FACES[shape] for corner in corners})


@dataclass(frozen=True)
class View:
    """A look at something from afar."""
    across: Array  # the direction to the right, of unit length, as the others
    up: Array
    towards: Array  # to the eye

    @classmethod
    def along(cls, towards: Array) -> View:
        """The view that shows z upwards."""
        towards = towards / np.linalg.norm(towards)
        across = np.cross([0.0, 0.0, 1.0], towards)
        across /= np.linalg.norm(across)
        return cls(across, np.cross(towards, across), towards)

    def of(self, points: Array) -> Array:
        """Places in the picture, and the depth, which grows towards the eye (..., 3)."""
        return points @ np.stack([self.across, self.up, self.towards], axis=1)


@dataclass(frozen=True)
class Seen:
    """What is seen of triangles, pixel by pixel; rows from above."""
    corners: Array  # of the triangles, in the picture (n, 3, 3)
    window: Array  # what is shown of it
    number: Array  # the triangle, -1 where there is none (height, width)
    depth: Array  # towards the eye (height, width)
    normals: Array  # of the triangles, in the picture (n, 3)
    edge: Array  # 0, 1 where another face begins, 2 where the body has an edge or an outline (height, width)

    @cached_property
    def weights(self) -> Array:
        """Of the corners of its triangle in each pixel (height, width, 3)."""
        return weights_of(self.corners, self.number, self.window)

    def values(self, corners: Array) -> Array:
        """What the corners of the triangles have (n_triangles, 3), pixel by pixel."""
        values: Array = (corners[self.number] * self.weights).sum(axis=-1)
        return values


def facing(corners: Array) -> Array:
    """Which triangles show their outer side in a picture (n)."""
    one, other = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    found: Array = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] > 0.0
    return found


def look(corners: Array, faces: Array, window: Array, size: tuple[int, int]) -> Seen:
    """What is seen in a window of triangles, whose corners have places and a depth in a picture (n, 3, 3), each a part
    of a face."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    width, height = (2 * count for count in size)  # see `smoothed`
    number, depth = nearest(corners, window, (width, height))
    face = np.append(faces, -1)[number]
    edge = np.zeros(number.shape, np.uint8)
    step = STEEP * np.ptp(window[:, 0]) / width
    for before, behind, shift in ((np.s_[:-1], np.s_[1:], width), (np.s_[:, :-1], np.s_[:, 1:], 1)):
        differs = np.zeros(number.shape, dtype=bool)
        differs[before] = face[before] != face[behind]
        here = np.flatnonzero(differs)
        there = here + shift
        edge.flat[here] = np.maximum(edge.flat[here], 1)
        one, other = normals[number.flat[here]], normals[number.flat[there]]
        turns = (one * other).sum(axis=1) < RIDGE
        # A face that is seen from its edge has large steps of depth by itself.
        slope = np.maximum(np.minimum(one[:, 2], other[:, 2]), 0.05)
        with np.errstate(invalid="ignore"):
            leaps = np.abs(depth.flat[here] - depth.flat[there]) > step / slope
        is_edge = turns | leaps
        for place in (here, there):
            edge.flat[place[is_edge]] = 2
    edge[number < 0] = 0
    return Seen(corners, window, number, depth, normals, edge)


def smoothed(image: Array) -> Array:
    """An image with two by two pixels as one: red, green, blue and opacity from 0 to 1 (height, width, 4)."""
    opacity = sum(image[i::2, j::2, 3:] for i in (0, 1) for j in (0, 1))
    colors = sum(image[i::2, j::2, :3] * image[i::2, j::2, 3:] for i in (0, 1) for j in (0, 1))
    found: Array = np.concatenate([colors / np.maximum(opacity, 1e-9), opacity / 4], axis=-1)
    return found
