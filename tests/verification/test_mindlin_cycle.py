#!/usr/bin/env python3
r"""Cycle of partial slip after Mindlin.

The block of *Partial slip*, pressed on the parabola in one step and then pushed to and fro. On a half plane whose
normal forces cause no slip the shear force swings between $Q^* = k \mu P$ and $-Q^*$. A cycle dissipates $W =
\frac{2\mu^2 P^2}{\pi E^*}[2(1-k)\ln(1-k) + k(2-k)]$, the first loading a quarter of that; when the force is back in the
middle, $|x| < c' = a\sqrt{1-k/2}$ has not slipped back (K. L. Johnson, *Contact Mechanics*, 1985, sections 7.2 and
7.4).

The first loading leaves the stick zone $c = a\sqrt{1-k}$; while the force falls from $Q^*$ to $Q$, the points beyond
$c' = a\sqrt{1-(Q^*-Q)/(2\mu P)}$ slip back, and the shear is $\mu p_0(-\sqrt{1-x^2/a^2} +
2\frac{c'}{a}\sqrt{1-x^2/c'^2} - \frac{c}{a}\sqrt{1-x^2/c^2})$. The tangential approach of the body on the first loading
is $\frac{\mu p_0 a}{E^*}(\Lambda k + \frac12 (1-k)\ln(1-k))$, $\Lambda$ that of the body without slip; a reversed
branch has twice that at half the fall of the force (Masing). $\Lambda$ cancels from a closed cycle. A reversed branch
has twice the slip under the same bound. Here the grip moves by given steps, and $P$ and $Q$ are those of the computed
forces; the branches are symmetric. $a$ and $c'$ are measured by second moments, $c'$ by that of $\mu p + q$. The cycle
is taken in 1 step for a branch and in 5: the bound does not change, no point slips back within a branch, so that the
dissipation is the same but for the small coupling of $\nu = 0.499$. Meshes and elements are those of *Partial slip*.
Tolerances on the finest mesh: 0.5 % of $W$, 0.25 % of $c'/a$; four times as much where the cells are twice as wide.
"""
import csv
import math

from benchmark import Benchmark, main
from convergence import ValueTable
from graded_block import graded_block

FRICTION = 0.5
ELEMENTS = ("tri6", "quad8", "quad9")


class MindlinCycle(Benchmark):
    """Dissipation of a cycle, and the zone that slips back."""
    modulus = 1000.0/(1 - 0.499**2)
    tolerance = 0.005

    def test_cycle(self):
        self.compare()

    def compare(self):
        """Compares cycles on several meshes."""
        table = ValueTable("Dissipation, and the zone that has not slipped back when the grip is in the middle again",
                           ["element", "h", "steps of a branch", "quantity"])
        finest = self.meshes(1/16, 1/32)
        for element in ELEMENTS:
            for h in self.meshes((1/16,), (1/8, 1/16, 1/32)):
                for n_steps in (1, 5) if h == finest else (1,):
                    self.add(table, element, h, n_steps, self.tolerance*(32*h)**2)
        self.assert_table(table)

    def add(self, table, element, h, n_steps, allowed):
        """Solves a mesh and adds its rows."""
        result = self.solve(self.cycle_deck(element, h, n_steps))
        self.assert_sound(result)
        steps = self.rows("history")
        pressed, pushed = (float(steps[n_steps][force]) for force in ("normal_force", "tangential_force"))
        k = pushed/(FRICTION*pressed)
        cycle = 2*(FRICTION*pressed)**2/(math.pi*self.modulus)*(2*(1 - k)*math.log(1 - k) + k*(2 - k))
        done = [float(row["dissipation"]) for row in steps]
        labels = (element, f"1/{round(1/h)}", n_steps)
        # Pressing alone: what the coupling dissipates.
        table.add(*labels, "first loading", computed=done[n_steps] - done[0], reference=cycle/4, allowed=allowed)
        table.add(*labels, "cycle", computed=done[-1] - done[n_steps], reference=cycle, allowed=allowed)
        computed, reference = self.reversed_zone(result["x"], 2*n_steps + 1, k)
        table.add(*labels, "c'/a", computed=computed, reference=reference, allowed=allowed/2)

    def cycle_deck(self, element, h, n_steps):
        """The deck of a cycle on a mesh."""
        mesh = graded_block(element, h, 40.0, 1.5, is_mirrored=True)
        return self.deck("mindlin_cycle", mesh=mesh, substeps=n_steps)

    def reversed_zone(self, x, step, k):
        """c'/a at a step, measured and exact."""
        points = [row for row in self.rows("points") if int(row["step"]) == step]
        normal = [float(row["normal_force"]) for row in points]
        shear = [float(row["tangential_force"]) for row in points]
        pressed, pushed = sum(normal), sum(shear)
        a = 2*math.sqrt(moment(x, normal)/pressed)
        # mu p + q is the sum of the pressures of Hertz 2 mu p(c') - mu p(c), with the second moments F c^2/4.
        inner = 1 - k
        total = 4*moment(x, [FRICTION*p + q for p, q in zip(normal, shear)])/(a**2*FRICTION*pressed)
        exact = math.sqrt(1 - (k - pushed/(FRICTION*pressed))/2)
        return ((total + inner**2)/2)**0.25, exact

    def rows(self, kind):
        """The rows of a table of the case."""
        with open(self.directory/f"case.{kind}.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))


def moment(x, force):
    """The second moment of forces about their middle."""
    middle = sum(f*place for f, place in zip(force, x))/sum(force)
    return sum(f*(place - middle)**2 for f, place in zip(force, x))


if __name__ == "__main__":
    main()
