"""Meshes made of arrays, for `solve_deck` and `Stepper`."""
from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike

from amontons.arguments import InputRefused, real_numbers, whole_numbers
from amontons.grid import FACES, Array

# Gmsh's numbers and the number of nodes of the kinds of cells, those of solids behind those of the plane.
PLANE = {"triangle": (2, 3), "quad": (3, 4), "triangle6": (9, 6), "quad8": (16, 8), "quad9": (10, 9)}
SOLID = {"tetra": (4, 4), "hexahedron": (5, 8), "tetra10": (11, 10), "hexahedron20": (17, 20)}
CELLS = {**PLANE, **SOLID}
# Where Gmsh has the nodes of a cell, if in another order.
ORDER = {"tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
         "hexahedron20": [*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14]}
# Gmsh's numbers of sides by their number of nodes, in the plane and of solids.
SIDES = {2: {2: 1, 3: 8}, 3: {3: 2, 4: 3, 6: 9, 8: 16}}
POINT = 15
# Kinds of cells by their dimension, as meshio calls them.
DIMENSIONS = {"vertex": 0, "line": 1, "line3": 1, **dict.fromkeys(PLANE, 2), **dict.fromkeys(SOLID, 3)}
FLATNESS = 1e-9  # how far nodes may leave their plane, over the size of the body
REST = "rest"  # the region of the cells that are in none


@dataclass(frozen=True)
class Mesh:
    """A mesh in arrays; numbers of nodes and cells count from 0. Middle nodes follow the corners, in the order of the
    sides, as in the grids that `read_grid` reads."""
    nodes: ArrayLike  # coordinates (n_nodes, 2), of solids (n_nodes, 3)
    cells: Sequence[tuple[str, ArrayLike]]  # pairs: a kind of CELLS, and the nodes of its cells (n_cells, n)
    # Boundary sets: the nodes of each side (n_sides, n), 2 or 3 in the plane, 3, 4, 6 or 8 of solids, whose corners
    # come first; a list of such arrays where sides differ.
    sides: Mapping[str, Union[ArrayLike, Sequence[ArrayLike]]] = field(default_factory=dict)
    points: Mapping[str, ArrayLike] = field(default_factory=dict)  # node sets: nodes (n)
    regions: Mapping[str, ArrayLike] = field(default_factory=dict)  # numbers of cells, all kinds in one row (n)

    @classmethod
    def from_meshio(cls, mesh: Any) -> Mesh:
        """A mesh as meshio has it: an object with `points` and `cells`. Names come from `point_sets`, `cell_sets` and
        the groups of Gmsh, `cell_data["gmsh:physical"]` with `field_data`. Sets of lines, of solids those of faces, are
        boundary sets, of cells regions; a set of points names the sides of the boundary between them, too. Of solids
        lines are sets of their nodes."""
        points = real_numbers(mesh.points, "points")
        blocks = [(block.type, np.asarray(block.data)) if hasattr(block, "type") else (block[0], np.asarray(block[1]))
                  for block in mesh.cells]
        for kind, _ in blocks:
            if kind not in DIMENSIONS:
                raise InputRefused(f"cells '{kind}': expected one of " + ", ".join(f"'{kind}'" for kind in DIMENSIONS))
        n_dim = max((DIMENSIONS[kind] for kind, _ in blocks), default=2)
        if n_dim < 3 and points.shape[1] > 2 and np.ptp(points[:, 2]) > FLATNESS*np.ptp(points, axis=0).max():
            raise InputRefused("3-D mesh: expected points in a plane z = constant, or tetrahedra and hexahedra")
        points_of: dict[str, Array] = {}
        sides: dict[str, list[Array]] = {}
        regions: dict[str, list[Array]] = {}
        first = 0
        for i, (kind, nodes) in enumerate(blocks):
            for name, members in _members(mesh, i, DIMENSIONS[kind]):
                if DIMENSIONS[kind] == n_dim:
                    regions.setdefault(name, []).append(first + members)
                elif DIMENSIONS[kind] == n_dim - 1:
                    sides.setdefault(name, []).append(nodes[members])
                else:
                    points_of[name] = np.union1d(points_of.get(name, []), nodes[members]).astype(int)
            first += len(nodes) if DIMENSIONS[kind] == n_dim else 0
        cells = [block for block in blocks if DIMENSIONS[block[0]] == n_dim]
        for name, members in (getattr(mesh, "point_sets", None) or {}).items():
            points_of[name] = np.asarray(members)
            between = _sides_between(cells, points_of[name], len(points))
            if name not in sides and between:
                sides[name] = between
        return cls(points[:, :n_dim], cells, sides, points_of,
                   {name: np.concatenate(parts) for name, parts in regions.items()})

    def text(self) -> str:
        """The mesh in Gmsh's format 2.2."""
        nodes = real_numbers(self.nodes, "nodes")
        n_dim = 3 if any(kind in SOLID for kind, _ in self.cells) else 2
        if nodes.ndim != 2 or nodes.shape[1] not in (n_dim, 3):
            raise InputRefused(f"expected nodes of n x {n_dim} numbers, found {nodes.shape}")
        sets = {0: self.points, n_dim - 1: self.sides, n_dim: {REST: None, **self.regions}}
        groups = [(dimension, name) for dimension, names in sets.items() for name in names]
        numbers = {group: number for number, group in enumerate(groups, 1)}
        elements: list[str] = []
        for name, members in self.points.items():
            members = np.reshape(whole_numbers(members, name), (-1, 1))
            self._add(elements, POINT, numbers[0, name], members, len(nodes), name)
        for name, parts in self.sides.items():
            for part in parts if _is_list_of_arrays(parts) else [parts]:
                members = np.atleast_2d(whole_numbers(part, name))
                number = SIDES[n_dim].get(members.shape[1])
                if number is None:
                    widths = ("2 or 3", "3, 4, 6 or 8")[n_dim - 2]
                    raise InputRefused(f"sides '{name}': expected {widths} nodes a side, found {members.shape[1]}")
                self._add(elements, number, numbers[n_dim - 1, name], members, len(nodes), name)
        self._add_cells(elements, {name: numbers[n_dim, name] for name in sets[n_dim]}, len(nodes), n_dim)
        places = np.zeros((len(nodes), 3))
        places[:, :n_dim] = nodes[:, :n_dim]
        names = [f'{dimension} {number} "{_name(name)}"' for (dimension, name), number in numbers.items()]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", len(names), *names, "$EndPhysicalNames",
                 "$Nodes", len(nodes), *(f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(places.tolist(), 1)),
                 "$EndNodes", "$Elements", len(elements), *(f"{i} {text}" for i, text in enumerate(elements, 1)),
                 "$EndElements"]
        return "\n".join(map(str, lines)) + "\n"

    def _add_cells(self, elements: list[str], numbers: Mapping[str, int], n_nodes: int, n_dim: int) -> None:
        """Adds the cells, each with the number of its region."""
        kinds = [(kind, np.atleast_2d(whole_numbers(nodes, kind))) for kind, nodes in self.cells]
        for kind, nodes in kinds:
            if kind not in CELLS or nodes.shape[1] != CELLS[kind][1]:
                raise InputRefused(f"cells '{kind}' of {nodes.shape[1]} nodes: expected one of "
                                 + ", ".join(f"'{name}' of {n}" for name, (_, n) in CELLS.items()))
            if DIMENSIONS[kind] != n_dim:
                raise InputRefused(f"cells '{kind}': expected solids alone, or none")
        n_cells = sum(len(nodes) for _, nodes in kinds)
        # Pairs of a cell and a region; the format repeats a cell for each region that it belongs to.
        members_of = {name: np.unique(_within(whole_numbers(members, name), n_cells, f"region '{name}'"))
                      for name, members in self.regions.items()}
        rest = np.setdiff1d(np.arange(n_cells), np.concatenate([[], *members_of.values()])).astype(int)
        members_of[REST] = np.concatenate([rest, members_of.get(REST, rest[:0])])
        cell = np.concatenate(list(members_of.values()))
        region = np.repeat([numbers[name] for name in members_of], [len(members) for members in members_of.values()])
        order = np.argsort(cell, kind="stable")
        cell, region = cell[order], region[order]
        start = 0
        for kind, nodes in kinds:
            here = (cell >= start) & (cell < start + len(nodes))
            ordered = nodes[:, ORDER[kind]] if kind in ORDER else nodes
            self._add(elements, CELLS[kind][0], region[here], ordered[cell[here] - start], n_nodes, kind)
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


def _members(mesh: Any, block: int, dimension: int) -> list[tuple[str, Array]]:
    """The named sets that cells of one block of a meshio mesh belong to, and which of the cells do."""
    sets = getattr(mesh, "cell_sets", None) or {}
    found = [(name, np.asarray(parts[block], dtype=int)) for name, parts in sets.items()
             if not name.startswith("gmsh:") and parts[block] is not None]
    physical = (getattr(mesh, "cell_data", None) or {}).get("gmsh:physical")
    if physical is not None:
        names = {tuple(map(int, number)): name for name, number in (getattr(mesh, "field_data", None) or {}).items()}
        numbers = np.asarray(physical[block])
        for number in map(int, np.unique(numbers[numbers > 0])):
            name = names.get((number, dimension), str(number))
            if name not in dict(found):
                found.append((name, np.flatnonzero(numbers == number)))
    return [(name, members) for name, members in found if len(members)]


def _is_list_of_arrays(parts: Any) -> bool:
    """Whether sides are given as several arrays of them."""
    return isinstance(parts, (list, tuple)) and any(np.ndim(part) == 2 for part in parts)


def _sides_between(cells: Sequence[tuple[str, Array]], points: Array, n_points: int) -> list[Array]:
    """The sides of the boundary whose corners are among some points, by their corners: arrays of sides (n_sides, n)."""
    by_width: dict[int, list[Array]] = {}
    for kind, nodes in cells:
        shape = kind.rstrip("0123456789")
        n = 3 if shape == "triangle" else 4
        for side in FACES.get(shape) or [[i, (i + 1) % n] for i in range(n)]:
            by_width.setdefault(len(side), []).append(nodes[:, side])
    is_among = np.zeros(n_points, dtype=bool)
    is_among[points] = True
    found = []
    for parts in by_width.values():
        sides = np.concatenate(parts)
        _, place, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
        sides = sides[place[count == 1]]
        sides = sides[is_among[sides].all(axis=1)]
        if len(sides):
            found.append(sides)
    return found


def _name(name: str) -> str:
    """A name that the format can hold."""
    if '"' in name or "\n" in name:
        raise InputRefused(f"a name with a quote or a line end: {name!r}")
    return name


def _within(values: Array, n: int, name: str) -> Array:
    """Numbers that are checked to lie from 0 to n - 1."""
    if values.size and not 0 <= values.min() <= values.max() < n:
        raise InputRefused(f"{name}: expected numbers from 0 to {n - 1}, found {values.min()} to {values.max()}")
    return values
