#!/usr/bin/env python3
r"""Size of the steps.

What friction takes in a step is the slip times a bound that may have changed within the step. With the bound at the end
(backward Euler) the error is of first order in the number of steps, with the mean of both ends, which the program
reports, of second order. One point shows both; the energy error of the long bar shows how fine the steps are, and is of
second order, too.

One point of stiffness $k$ shows both: its neighbors move by $\delta = \delta_0(1 + 2t)$, $N = N_0(1 + t^2)$ presses it,
so that it slips from the first step on and friction takes

```math
\int_0^1 \mu N \left(\dot\delta - \frac{\mu \dot N}{k}\right) dt
= \frac{8}{3}\mu N_0 \delta_0 - \frac{3}{2k}(\mu N_0)^2,
```

to which the mean bounds of $n$ steps add $\mu N_0 \delta_0/(3n^2)$ exactly. Of a history whose dissipation is not known
in closed form, that of the long bar, the energy error (work less strain energy and dissipation) shows how fine the
steps are: it is of second order, too. There $h$ is the length of a step, a leg being 1.
"""
import shutil

from benchmark import DECKS, main
from convergence import ConvergenceTable, ValueTable
from history_benchmark import HistoryBenchmark

LIMIT, DISTANCE, STIFFNESS = 3.0, 0.01, 1000.0
EXACT = 8/3*LIMIT*DISTANCE - 1.5*LIMIT**2/STIFFNESS


class StepSize(HistoryBenchmark):
    """Orders of convergence of dissipation and energy error."""

    def test_dissipation_of_a_point(self):
        table = ConvergenceTable("Dissipation of one point", ["dissipation"], {"end": (1,), "mean": (2,)}, kind="bound")
        values = ValueTable("With mean bounds", ["steps", "quantity"])
        shutil.copy(DECKS/"step_size.csv", self.directory)
        for n in (4, 8, 16, 32, 64):
            first, *rows = self.steps(self.deck("step_size", substeps=n))
            mean = rows[-1]["dissipation"] - first["dissipation"]
            end = sum(row["tangential_force"]*row["slip_step"] for row in self.rows("points")[1:])
            table.add("end", 1/n, abs(end/EXACT - 1))
            table.add("mean", 1/n, abs(mean/EXACT - 1))
            values.add(n, "dissipation", computed=mean, reference=EXACT + LIMIT*DISTANCE/(3*n**2), allowed=1e-10)
        table.close()
        self.assert_table(table)
        self.assert_table(values)

    def test_energy_error_of_the_long_bar(self):
        table = ConvergenceTable("Energy error of the long bar, over the dissipation", ["energy"], {"mean": (2,)},
                                 kind="bound")
        for n in self.meshes((5, 10, 20), (5, 10, 20, 40, 80, 160)):
            end = self.steps(self.deck("bar_history", substeps=n))[-1]
            table.add("mean", 1/n, abs(end["energy_error"]/end["dissipation"]))
        table.close()
        self.assert_table(table)


if __name__ == "__main__":
    main()
