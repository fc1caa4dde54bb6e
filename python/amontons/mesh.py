"""Meshes made of arrays, for `solve_deck`."""
from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from amontons.grid import Array

# Gmsh's numbers of the kinds of cells, and of sides by their number of nodes.
CELLS = {"triangle": (2, 3), "quad": (3, 4), "triangle6": (9, 6), "quad8": (16, 8), "quad9": (10, 9)}
SIDES = {2: 1, 3: 8}
POINT = 15
REST = "rest"  # the region of the cells that are in none


@dataclass(frozen=True)
class Mesh:
    """A mesh in arrays; numbers of nodes and cells count from 0. Middle nodes follow the corners, in the order of the
    sides, as in the grids that `read_grid` reads."""
    nodes: ArrayLike  # coordinates (n_nodes, 2)
    cells: Sequence[tuple[str, ArrayLike]]  # pairs: a kind of CELLS, and the nodes of its cells (n_cells, n)
    sides: Mapping[str, ArrayLike] = field(default_factory=dict)  # boundary sets: nodes of each side (n_sides, 2 or 3)
    points: Mapping[str, ArrayLike] = field(default_factory=dict)  # node sets: nodes (n)
    regions: Mapping[str, ArrayLike] = field(default_factory=dict)  # numbers of cells, all kinds in one row (n)

    def text(self) -> str:
        """The mesh in Gmsh's format 2.2."""
        nodes = np.asarray(self.nodes, dtype=float)
        if nodes.ndim != 2 or nodes.shape[1] not in (2, 3):
            raise ValueError(f"expected nodes of n x 2 numbers, found {nodes.shape}")
        sets = (self.points, self.sides, {REST: None, **self.regions})
        groups = [(dimension, name) for dimension, names in enumerate(sets) for name in names]
        numbers = {group: number for number, group in enumerate(groups, 1)}
        elements: list[str] = []
        for name, members in self.points.items():
            self._add(elements, POINT, numbers[0, name], np.reshape(_whole(members, name), (-1, 1)), len(nodes), name)
        for name, members in self.sides.items():
            members = np.atleast_2d(_whole(members, name))
            if members.shape[1] not in SIDES:
                raise ValueError(f"sides '{name}': expected 2 or 3 nodes a side, found {members.shape[1]}")
            self._add(elements, SIDES[members.shape[1]], numbers[1, name], members, len(nodes), name)
        self._add_cells(elements, numbers, len(nodes))
        names = [f'{dimension} {number} "{_name(name)}"' for (dimension, name), number in numbers.items()]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", len(names), *names, "$EndPhysicalNames",
                 "$Nodes", len(nodes), *(f"{i} {float(x[0])!r} {float(x[1])!r} 0" for i, x in enumerate(nodes, 1)),
                 "$EndNodes", "$Elements", len(elements), *(f"{i} {text}" for i, text in enumerate(elements, 1)),
                 "$EndElements"]
        return "\n".join(map(str, lines)) + "\n"

    def _add_cells(self, elements: list[str], numbers: Mapping[tuple[int, str], int], n_nodes: int) -> None:
        """Adds the cells, each with the number of its region."""
        kinds = [(kind, np.atleast_2d(_whole(nodes, kind))) for kind, nodes in self.cells]
        for kind, nodes in kinds:
            if kind not in CELLS or nodes.shape[1] != CELLS[kind][1]:
                raise ValueError(f"cells '{kind}' of {nodes.shape[1]} nodes: expected one of "
                                 + ", ".join(f"'{name}' of {n}" for name, (_, n) in CELLS.items()))
        region = np.full(sum(len(nodes) for _, nodes in kinds), numbers[2, REST])
        for name, members in self.regions.items():
            region[_within(_whole(members, name), len(region), f"region '{name}'")] = numbers[2, name]
        start = 0
        for kind, nodes in kinds:
            self._add(elements, CELLS[kind][0], region[start:start + len(nodes)], nodes, n_nodes, kind)
            start += len(nodes)

    @staticmethod
    def _add(elements: list[str], number: int, group: ArrayLike, nodes: Array, n_nodes: int, name: str) -> None:
        """Adds elements of one kind."""
        _within(nodes, n_nodes, f"'{name}'")
        for one, members in zip(np.broadcast_to(group, len(nodes)), nodes + 1):
            elements.append(f"{number} 2 {one} {one} " + " ".join(map(str, members)))

    def write(self, directory: Path) -> Path:
        """Writes the mesh under a name that its content gives. Returns the path."""
        text = self.text().encode()
        path = Path(directory) / f"mesh_{zlib.crc32(text):08x}.msh"
        path.write_bytes(text)
        return path


def _name(name: str) -> str:
    """A name that the format can hold."""
    if '"' in name or "\n" in name:
        raise ValueError(f"a name with a quote or a line end: {name!r}")
    return name


def _whole(values: ArrayLike, name: str) -> Array:
    """Whole numbers."""
    found = np.asarray(values)
    if found.dtype.kind not in "iu":
        raise ValueError(f"'{name}': expected whole numbers, found {found.dtype}")
    return found


def _within(values: Array, n: int, name: str) -> Array:
    """Numbers that are checked to lie from 0 to n - 1."""
    if values.size and not 0 <= values.min() <= values.max() < n:
        raise ValueError(f"{name}: expected numbers from 0 to {n - 1}, found {values.min()} to {values.max()}")
    return values
