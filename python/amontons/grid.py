"""Reads the grids that Amontons writes, NAME.vtu and NAME.contact.vtu; doc/output.md explains their arrays."""
from __future__ import annotations

import base64
import os
from dataclasses import dataclass
from typing import Any, Union
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # of numbers
KINDS = {1: "vertex", 3: "line", 5: "triangle", 9: "quad", 22: "triangle6", 23: "quad8", 28: "quad9",
         10: "tetra", 12: "hexahedron", 24: "tetra10", 25: "hexahedron20"}
# The faces of solid cells by their corners, counterclockwise from outside; the edges in the order of middle nodes.
FACES = {"tetra": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
         "hexahedron": [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]}
EDGES = {"tetra10": [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)],
         "hexahedron20": [(0, 1), (1, 2), (2, 3), (0, 3), (4, 5), (5, 6), (6, 7), (4, 7), (0, 4), (1, 5), (2, 6),
                          (3, 7)]}
TYPES = {"Float64": "<f8", "Int32": "<i4"}
LENGTH = 8  # bytes: an array stands behind its length


@dataclass(frozen=True)
class Grid:
    """A mesh and what is known on its points and cells."""
    points: Array  # coordinates (n_points, 3)
    cells: list[tuple[str, Array]]  # the kind of some consecutive cells, and their points, from 0 (n_cells, n)
    point_data: dict[str, Array]    # arrays by name (n_points) or (n_points, n_components)
    cell_data: dict[str, Array]     # arrays by name (n_cells) or (n_cells, n_components), all cells in turn

    @property
    def is_solid(self) -> bool:
        """Whether its cells are solids."""
        return bool(self.cells) and self.cells[0][0].startswith(("tetra", "hexahedron"))


def read_grid(path: Union[str, os.PathLike[str]]) -> Grid:
    """Reads a grid; a ValueError says that the file is damaged."""
    try:
        root = ElementTree.parse(path).getroot()
        sections = {section.tag: {array.attrib["Name"]: _values(array) for array in section}
                    for section in root.findall("UnstructuredGrid/Piece/*")}
        return Grid(sections["Points"]["points"], _blocks(**sections["Cells"]), sections["PointData"],
                    sections.get("CellData", {}))
    except (ElementTree.ParseError, LookupError, TypeError, ValueError):
        raise ValueError(f"{path}: damaged, or not a grid of Amontons") from None


def part(grid: Grid, wanted: Array) -> Grid:
    """The points of a grid that are wanted, and the cells between them; without data of cells."""
    number = np.cumsum(wanted) - 1
    cells = [(kind, number[nodes[wanted[nodes].all(axis=1)]]) for kind, nodes in grid.cells]
    return Grid(grid.points[wanted], [(kind, nodes) for kind, nodes in cells if len(nodes)],
                {name: values[wanted] for name, values in grid.point_data.items()}, {})


def _values(array: ElementTree.Element) -> Array:
    """The numbers of an array."""
    values = np.frombuffer(base64.b64decode(array.text or "")[LENGTH:], TYPES[array.attrib["type"]])
    width = int(array.get("NumberOfComponents", "1"))
    return values if width == 1 else values.reshape(-1, width)


def _blocks(connectivity: Array, offsets: Array, types: Array) -> list[tuple[str, Array]]:
    """The cells, those of one kind that follow each other together."""
    blocks = []
    for cells in np.split(np.arange(len(types)), np.flatnonzero(np.diff(types)) + 1):
        if len(cells):
            start = offsets[cells[0] - 1] if cells[0] else 0
            nodes = connectivity[start:offsets[cells[-1]]].reshape(len(cells), -1)
            blocks.append((KINDS[types[cells[0]]], nodes))
    return blocks
