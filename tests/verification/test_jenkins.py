#!/usr/bin/env python3
r"""Spring and slider.

The smallest history: one free node of stiffness $k$ under the force $N$, whose neighbors move by $\delta$ to and fro
(Jenkins' element). It sticks until the spring force is $\mu N$ and slips then, whatever the number of steps: the first
loading dissipates $\mu N (\delta - \mu N/k)$, a closed cycle four times that. The same with all else at rest and a
floor that moves.

The floor rises by $y$, which presses the node with $N = k y$ at the cost of the work $k y^2/2$, shifts to and fro by
$\delta$, and at the end turns by $w$ about a far point, which shifts it on by $w R$. Then the work of the obstacle is
dissipation and strain energy. All is exact to rounding, but for the turn, which changes the height of the floor by $R
w^2/2 + w \delta$, $1.5\cdot 10^{-6} y$.
"""
from benchmark import DECKS, main
from convergence import ValueTable
from history_benchmark import HistoryBenchmark

STIFFNESS, LIMIT, NORMAL, AMPLITUDE = 1000.0, 3.0, 10.0, 0.01
SLIP = AMPLITUDE - LIMIT/STIFFNESS
CYCLE = 4*LIMIT*SLIP
SPRING = LIMIT**2/(2*STIFFNESS)
ROUNDING = 1e-12
NUMBERS = (1, 2, 7, 20)


class Jenkins(HistoryBenchmark):
    """Dissipation and work of one point."""

    def test_moving_neighbors(self):
        table = ValueTable("Neighbors that move", ["steps between turns", "quantity"])
        for n in NUMBERS:
            rows = self.steps(self.deck("jenkins", substeps=n))
            done = [row["dissipation"] for row in rows]
            table.add(n, "dissipation of the first loading", computed=done[n], reference=CYCLE/4, allowed=ROUNDING)
            table.add(n, "dissipation of the cycle", computed=done[-1] - done[n], reference=CYCLE, allowed=ROUNDING)
            table.add(n, "accumulated slip", computed=rows[-1]["max_slip_accumulated"], reference=5*SLIP,
                      allowed=ROUNDING)
            # The node bears a length of 1.
            point, = self.rows("contact")
            table.add(n, "wear integral", computed=point["wear_integral"], reference=5*SLIP*NORMAL, allowed=ROUNDING)
            table.add(n, "strain energy", computed=rows[-1]["strain_energy"], reference=SPRING, allowed=ROUNDING)
            table.add(n, "force", computed=rows[-1]["tangential_force"], reference=LIMIT, allowed=ROUNDING)
        self.assert_table(table)

    def test_moving_floor(self):
        table = ValueTable("A floor that moves", ["steps between turns", "motion", "quantity"])
        pressing = NORMAL**2/(2*STIFFNESS)
        self.write("moving_floor.csv", (DECKS/"moving_floor.csv").read_text(encoding="utf-8"))
        for n in NUMBERS:
            rows = self.steps(self.deck("moving_floor", substeps=n))
            after = {"rise": (0.0, pressing, ROUNDING), "shift": (CYCLE/4, pressing + SPRING, ROUNDING),
                     "shift back": (3*CYCLE/4, pressing + SPRING, ROUNDING),
                     "shift again": (5*CYCLE/4, pressing + SPRING, ROUNDING),
                     "turn": (5*CYCLE/4 + LIMIT*AMPLITUDE, pressing + SPRING, 4e-6)}
            for motion, row in zip(after, rows[n::n]):
                friction, strain, allowed = after[motion]
                if friction > 0:
                    table.add(n, motion, "dissipation", computed=row["dissipation"], reference=friction,
                              allowed=allowed)
                table.add(n, motion, "strain energy", computed=row["strain_energy"], reference=strain, allowed=allowed)
            # The force is linear within every step only where slip begins at the end of one, as after 6 of 20.
            if n == 20:
                table.add(n, "shift again", "work of the floor", computed=rows[4*n]["work_obstacles"],
                          reference=pressing + SPRING + 5*CYCLE/4, allowed=ROUNDING)
        self.assert_table(table)


if __name__ == "__main__":
    main()
