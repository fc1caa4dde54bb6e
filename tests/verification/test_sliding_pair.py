#!/usr/bin/env python3
r"""Bodies that slide over many sides of each other.

With `sliding = 'finite'` a pair meets where its bodies are. A block is pressed on a floor of other sides and pushed
along it, far and by any part of a side; its pressure stays the same everywhere. A wedge is pushed along the flank of a
lug that bends by 6.2 mrad under it. The forces of reference are those of CalculiX 2.20 on the same mesh with 10 and 40
increments, extrapolated to infinitely many. A pair that keeps its partners gives the ratio 0.53846, which is 1.5 %
less, and a force that is 2.0 % larger. A tool with the radius 3 irons an elastic floor: the force of the pressed tool
by CalculiX, and how it ripples while sides pass. A foot of the same radius under a given load $P$ is drawn over a rigid
circle with the radius 2: the push is $P \tan(\varphi - \theta)$ where the circle descends by $\theta$, $\tan\varphi =
\mu$. A shaft is pulled out of its hub: while $L$ is left in it, $F = 2\pi a^2 p/\nu\,(1 - e^{-\mu\nu L/a})$ with Lamé's
pressure $p$, since a pulled shaft gets thinner.

Tolerances: rounding for the block; 0.05 % for the flank, which is what increments of CalculiX leave; 0.2 % for the
pressed tool, 1 % for its ripple; 0.1 % for the foot, which bends back by the shear. For the shaft 2 and 4 % of the
change of the force between two places: the formula takes the axial stress of the hub as the same over its section.
"""
import math

from benchmark import ELEMENTS, main
from convergence import ValueTable
from history_benchmark import HistoryBenchmark
from mapped_mesh import mapped_mesh


def stations(*parts):
    """A function from [0, 1] to a line that is divided into equal cells from each number to the next: the cells of all
    parts take equal parts of [0, 1]."""
    places = [parts[0][0]] + [a + (b - a)*k/n for a, b, n in parts for k in range(1, n + 1)]

    def at(s):
        cell = min(int(s*(len(places) - 1) + 1e-9), len(places) - 2)
        return places[cell] + (s*(len(places) - 1) - cell)*(places[cell + 1] - places[cell])
    return at


def flank():
    """The meshes of the wedge and of the lug; the flank is the top of each, below the pressed sides."""
    along = stations((8.0, 5.0, 8), (5.0, 0.0, 25))
    wedge = mapped_mesh((33, 20), "quad4", lambda s, t: (t*(10.0 - min(along(s), 5.0)), along(s)), n_pressed=8)
    up = stations((-12.0, -1.0, 24), (-1.0, 0.0, 4), (0.0, 5.0, 22))

    def lug(s, t):
        return 16.0 + t*((11.0 if up(s) <= -1.0 else 10.0 - up(s)) - 16.0), up(s)
    return wedge, mapped_mesh((50, 16), "quad4", lug, n_pressed=24)


def tool(n_sides):
    """The mesh of a tool with a bottom of radius 3 and so many sides."""
    rows = [sum(1.25**k for k in range(n))/sum(1.25**k for k in range(8)) for n in range(9)]
    up = stations(*((a, b, 1) for a, b in zip(rows, rows[1:])))

    def place(s, t):
        x = -0.4 + 0.8*s
        return x, 0.5*up(t) + (3.0 - math.sqrt(9.0 - x*x))*(1.0 - up(t))
    return mapped_mesh((n_sides, 8), "quad4", place)


class SlidingPair(HistoryBenchmark):
    """Forces of bodies on their way."""

    def with_roles(self, deck, is_exchanged):
        """A deck with set and against exchanged."""
        if not is_exchanged:
            return deck
        words = deck.split("'")
        at = next(i for i, word in enumerate(words) if word.endswith("&contact set = "))
        words[at + 1], words[at + 3] = words[at + 3], words[at + 1]
        return "'".join(words)

    def test_block(self):
        table = ValueTable("Least and largest pressure of the block", ["element", "way"])
        for element in self.meshes(("quad4", "quad8"), ELEMENTS):
            for way in (0.1, 1.0, 1.23456):
                deck = self.deck("moved_patch").replace("1.23456", repr(way)).replace("quad4", element)
                result = self.solve(deck)
                self.assert_sound(result)
                pressures = [pressure for pressure in result["contact_pressure"] if pressure > 0]
                for pressure in (min(pressures), max(pressures)):
                    table.add(element, f"{way:g}", computed=pressure, reference=10.0, allowed=1e-8)
        self.assert_table(table)

    def test_flank(self):
        table = ValueTable("Forces on the wedge", ["force", "slave", "steps"])
        for slave, steps in (("wedge", 1), ("wedge", 10), ("lug", 1)):
            for name, mesh in zip(("flank_wedge.msh", "flank_lug.msh"), flank()):
                self.write(name, mesh)
            deck = self.deck("sliding_flank", substeps=steps)
            last = self.steps(self.with_roles(deck, slave == "lug"))[-1]
            along, across = last["reaction_y_push"], last["reaction_x_wedge.bottom"]
            table.add("along", slave, steps, computed=along, reference=139.960, allowed=5e-4)
            table.add("across over along", slave, steps, computed=across/along, reference=0.54677, allowed=5e-4)
        self.assert_table(table)

    def test_ironing(self):
        table = ValueTable("Force of the tool", ["what", "slave"])
        for slave in ("tool", "floor"):
            self.write("ironing_tool.msh", tool(20))
            steps = self.steps(self.with_roles(self.deck("ironing"), slave == "floor"))
            table.add("pressed", slave, computed=-steps[1]["reaction_y_press"], reference=2.0609, allowed=2e-3)
            forces = [-row["reaction_y_press"] for row in steps[len(steps)//3:]]
            table.add("largest over least", slave, computed=max(forces)/min(forces), reference=1.0, allowed=1e-2)
        self.assert_table(table)

    def test_bump(self):
        table = ValueTable("Push of the foot over its load", ["place"])
        self.write("ironing_tool.msh", tool(40))
        for row in self.steps(self.deck("bump"))[2:]:
            place = row["time"] - 1.5
            table.add(f"{place:+.1f}", computed=row["reaction_x_foot"]/10, allowed=1e-3,
                      reference=math.tan(math.atan(0.4) - math.asin(place/(2.0 + 3.0))))
        self.assert_table(table)

    def test_pull_out(self):
        table = ValueTable("Change of the force over the way", ["friction", "slave"])
        # Lamé's pressure of a solid shaft of radius 1 in a hub of radius 2.
        pressure = 1000.0*0.002/2*(1 - 1/4)
        for friction in (0.05, 0.3):
            for slave in ("hub", "shaft"):
                steps = self.steps(self.with_roles(self.deck("pull_out", friction=friction), slave == "shaft"))
                force = {row["time"]: row["reaction_y_pull"] for row in steps}
                # With 5.5 and 4.5 in the hub.
                exact = 2*math.pi*pressure/0.3*(math.exp(-4.5*0.3*friction) - math.exp(-5.5*0.3*friction))
                table.add(f"{friction:g}", slave, computed=force[1.25] - force[1.75], reference=exact,
                          allowed=2e-2 if friction < 0.1 else 4e-2)
        self.assert_table(table)


if __name__ == "__main__":
    main()
