#!/usr/bin/env python3
r"""The long bar through a history.

The bar of Table 1 with $\mu = 1$ or $0.2$, pressed and pushed by $F = 10$ in proportion, then $F = 15, 5, -15, 10$. The
first state is that of the static case, the second row 2 of the table, as pushing on undoes nothing; the last, with the
loads of the first, is another. The reference is a program of its own, written for this purpose: active sets on the
same 32 by 10 cells. Contact by the trapezoidal rule in GetFEM, its `wt` as the anchor, agrees with it in ten
digits. Zones are equal, displacements and energies agree in all digits that were noted.
"""
from benchmark import main
from convergence import ValueTable
from history_benchmark import HistoryBenchmark

# At the end of a leg: lengths that are open, slip and stick, and the displacement of the corner.
STATES = {1: (3.75, 20.0, 16.25, 0.014488876), 2: (3.75, 27.5, 8.75, 0.02845943843),
          5: (3.75, 25.0, 11.25, 0.013855954)}
# By friction and number of steps of a leg: dissipation, and work less strain energy where it was noted.
ENERGIES = {(1.0, 1): (6.018874, 3.0506), (1.0, 4): (6.004551, 5.8909), (1.0, 20): (6.019907, 6.010977),
            (1.0, 80): (6.015675, 6.015146), (1.0, 320): (6.015285, 6.015257), (0.2, 1): (3.3152, None),
            (0.2, 4): (3.2509, None), (0.2, 20): (3.238117, None), (0.2, 80): (3.23748, None),
            (0.2, 320): (3.237433, 3.237413)}



class BarHistory(HistoryBenchmark):
    """States and energies of the bar."""

    def test_states(self):
        table = ValueTable(r"States, $\mu = 1$", ["leg", "steps of a leg", "quantity"])
        for n in (1, 4, 20):
            rows = self.steps(self.deck("bar_history", substeps=n))
            for leg, (*lengths, displacement) in STATES.items():
                row = rows[n*leg]
                for zone, length in zip(("open", "slip", "stick"), lengths):
                    table.add(leg, n, f"{zone} length", computed=row[f"{zone}_length"], reference=length,
                              allowed=1e-12)
                table.add(leg, n, "$u_x$ at (0, 0)", computed=row["ux_1"], reference=displacement,
                          allowed=half_a_digit(displacement))
        self.assert_table(table)

    def test_energies(self):
        table = ValueTable("Energies of all legs", [r"$\mu$", "steps of a leg", "quantity"])
        for (friction, n), (dissipation, balance) in ENERGIES.items():
            if not self.is_printing and n > 20:
                continue
            # The reference took the first leg in one step, which is no other in proportion with mean bounds.
            end = self.steps(self.deck("bar_history", friction=friction, substeps=n))[-1]
            table.add(friction, n, "dissipation", computed=end["dissipation"], reference=dissipation,
                      allowed=half_a_digit(dissipation))
            if balance:
                works = end["work_loads"] + end["work_supports"] + end["work_obstacles"]
                table.add(friction, n, "work less strain energy", computed=works - end["strain_energy"],
                          reference=balance, allowed=half_a_digit(balance))
        self.assert_table(table)


def half_a_digit(value):
    """Half of the last digit that was noted, over the value."""
    return 0.5/(value*10**len(repr(value).partition(".")[2]))


if __name__ == "__main__":
    main()
