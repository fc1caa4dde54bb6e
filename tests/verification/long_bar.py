"""The long bar of Pop and Zelina (2005), the five rows of its Table 1, and decks of it in other forms.

Geometry and material are those of code_aster's test SSNV128 (V6.04.128), with whose data the table comes out: half of a
section of 40 mm x 40 mm on a rigid floor, 32 x 10 cells, pushed along the floor by F on its side x = 0 and pressed down
by f on its top; x = 40 is the symmetry plane. Units: mm and daN.
"""
from dataclasses import dataclass, replace

from harness import ProgramTest

LENGTH = 40.0
SEGMENT = 1.25  # of the floor, on 32 cells
ROWS = (1, 2, 3, 4, 5)
SIDES = ("bottom", "right", "top", "left")  # counter-clockwise
INWARD = ((0, 1), (-1, 0), (0, -1), (1, 0))


@dataclass(frozen=True)
class Bar:
    """A row of the table and the form its deck has."""
    friction: float
    push: float
    pressure: float
    element: str = "quad4"
    diagonal: str = "right"
    cells: tuple = (32, 10)  # along the floor, across it
    young: float = 13000.0
    length_unit: float = 1.0  # mm in the units of the deck
    stress_unit: float = 1.0  # daN/mm^2 in the units of the deck
    turns: int = 0  # quarter turns, counter-clockwise
    is_mirrored: bool = False  # x -> 40 - x, before any turn
    solver: str = ""
    further_groups: str = ""

    def vector(self, x, y):
        """A vector given in the bar's own position."""
        if self.is_mirrored:
            x = -x
        for _ in range(self.turns):
            x, y = -y, x
        return f"{x*self.stress_unit!r}, {y*self.stress_unit!r}"

    def side(self, name):
        """The number of the side that a side in the bar's own position has become."""
        number = SIDES.index(name)
        if self.is_mirrored:
            number = -number % 4
        return (number + self.turns) % 4

    def deck(self):
        """The text of the deck."""
        size = LENGTH*self.length_unit
        floor = self.side("bottom")
        normal = INWARD[floor]
        along = self.turns % 2
        return f"""\
&mesh size = {size!r}, {size!r}  cells = {self.cells[along]}, {self.cells[1 - along]}
      element = '{self.element}'  diagonal = '{self.diagonal}' /
&material young = {self.young*self.stress_unit!r}  poisson = 0.2 /
&support set = '{SIDES[self.side('right')]}'  un = 0.0 /
&load set = '{SIDES[self.side('left')]}'  traction = {self.vector(self.push, 0.0)} /
&load set = '{SIDES[self.side('top')]}'  traction = {self.vector(0.0, -self.pressure)} /
&contact set = '{SIDES[floor]}'  friction = {self.friction!r}
         point = {-min(normal[0], 0)*size!r}, {-min(normal[1], 0)*size!r}  normal = {normal[0]}, {normal[1]} /
&solver {self.solver} /
{self.further_groups}
"""


TABLE = {
    1: Bar(1.0, 10.0, 5.0),
    2: Bar(1.0, 15.0, 5.0),
    3: Bar(0.2, 10.0, 5.0),
    4: Bar(0.2, 10.0, 15.0),
    5: Bar(0.2, 10.0, 25.0),
}
# Meshes of 32 x 10 cells: quadrilaterals, and triangles with each of the diagonals.
MESHES = (("quad4", "right"), ("tri3", "right"), ("tri3", "left"), ("tri3", "alternating"))


class LongBarTest(ProgramTest):
    """Solves rows of the table."""

    def solve_rows(self, status=0, rows=ROWS, options=(), **form):
        """Solves rows of the table, all in a form, in one run; returns the results by row."""
        decks = [self.write(f"row_{row}.nml", replace(TABLE[row], **form).deck()) for row in rows]
        self.run_program("--quiet", *options, *decks, status=status)
        return {row: self.result(f"row_{row}") for row in rows}

    def assert_forces(self, found, expected, tolerance, scale=1.0, message=None):
        """Checks contact forces against others times a scale, within a part of the largest one."""
        forces = [scale*force for force in expected.forces]
        self.assert_close(found.forces, forces, tolerance*max(map(abs, forces)), message)
