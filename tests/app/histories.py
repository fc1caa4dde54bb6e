"""Decks with &history, and what their files say."""
import csv
import io
import json

from verification import Verification

BAR = """&case name = 'bar' /
&mesh size = 40.0, 40.0  cells = 32, 10 /
&material young = 13000.0  poisson = 0.2  hypothesis = 'plane strain' /
&support set = 'right'  ux = 0.0 /
&load name = 'F'  set = 'left'  traction = 1.0, 0.0 /
&load name = 'f'  set = 'top'  traction = 0.0, -5.0 /
&contact set = 'bottom'  friction = 1.0 /
&history times = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0  substeps = 4 /
&steps load = 'F'  factor = 0.0, 10.0, 15.0, 5.0, -15.0, 10.0 /
&steps load = 'f'  factor = 0.0, 1.0, 1.0, 1.0, 1.0, 1.0 /
"""
BLOCK = """&case name = 'block' /
&mesh size = 4.0, 2.0  cells = 8, 4 /
&material young = 100.0  poisson = 0.25 /
&load name = 'push'  set = 'left'  traction = 1.0, 0.0 /
&load set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.3 /
"""
PUSHED = """&history times = 0.0, 1.0 /
&steps load = 'push'  factor = 0.0, 1.0 /
"""
CLUTCH = """&mesh name = 'lower'  size = 1.0, 0.5  cells = 6, 3  origin = 1.0, 0.0 /
&mesh name = 'upper'  size = 1.0, 0.5  cells = 4, 2  origin = 1.0, 0.5 /
&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true. /
&support set = 'lower.bottom'  uy = 0.0  turn = 0.0 /
&load name = 'press'  set = 'upper.top'  pressure = 2.0 /
&load name = 'turn'  set = 'upper.top'  torque = 6.0 /
"""
DISC = "&contact name = 'disc'  set = 'upper.bottom'  against = 'lower.top'  friction = 0.3 /\n"
# All of the disc slips at 2/3 pi mu p (b^3 - a^3) = 8.8.
TO_AND_FRO = """&history times = 0.0, 1.0, 2.0, 3.0  substeps = 4 /
&steps load = 'press'  factor = 0.0, 1.0, 1.0, 1.0 /
&steps load = 'turn'  factor = 0.0, 0.0, 1.4, -1.4 /
&output points_every = 4  states_every = 4  fields_every = 8  probe = 2.0, 1.0 /
"""


class HistoryTest(Verification):
    """Decks with &history."""

    def setUp(self):
        super().setUp()
        self.results = self.directory / "out"

    def walk(self, text, status=0):
        """Runs a deck."""
        return self.run_program("--quiet", "--output", "out", self.write("deck.nml", text), status=status)

    def text(self, name):
        """What a file of the results says."""
        return (self.directory / "out" / name).read_text(encoding="utf-8")

    def grids(self):
        """The names of the grids of single steps."""
        return sorted(path.name for path in (self.directory / "out").glob("*.history/*"))

    def table(self, name):
        """The rows of a table."""
        return list(csv.DictReader(io.StringIO(self.text(name))))

    def summary(self, name):
        """The summary of a case."""
        return json.loads(self.text(f"{name}.summary.json"))

    def contents_of_results(self):
        """The files in the folder of the results, if there is one."""
        return list((self.directory / "out").glob("*"))
