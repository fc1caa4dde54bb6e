#!/usr/bin/env python3
r"""Column that wears.

A column of height $H$, pressed by $\delta$ between a plate and a floor, without friction and with Poisson's ratio 0.
The floor slides below it by $s$ in all and wears it by Archard's law, $dh = k p\, ds$. The pressure is uniform,
$p = E (\delta - h)/H$, so that $p = (E \delta/H)\, e^{-k E s/H}$.

Each step has the depth worn before it in its gap, and wears by the mean of the pressures at its ends: a recurrence,
which the program follows to rounding. The error of the recurrence falls like the length of the steps. The worn volume
is $k \int N\, ds$. The wear takes its work, which is that of the floor, from the strain energy: energies balance to
rounding.
"""
from math import exp

from benchmark import main
from convergence import ConvergenceTable, ValueTable
from history_benchmark import HistoryBenchmark

YOUNG, HEIGHT, AREA, DELTA, WEAR, WAY = 1000.0, 4.0, 1.0, 0.01, 1e-4, 100.0
ROUNDING = 1e-12


def recurrence(n):
    """Pressures at the ends of n steps, and the depth worn in the end."""
    depth, pressures = 0.0, [YOUNG*DELTA/HEIGHT]
    for _ in range(n):
        pressures.append(YOUNG*(DELTA - depth)/HEIGHT)
        depth += WEAR*(WAY/n)*(pressures[-1] + pressures[-2])/2
    return pressures, depth


class WornColumn(HistoryBenchmark):
    """Pressure and worn depth under a prescribed displacement."""

    def test_pressure_falls_by_wear(self):
        values = ValueTable("The recurrence of the steps", ["steps", "quantity"])
        errors = ConvergenceTable("The exponential", ["p"], {"steps": (1,)}, kind="length of", allowance=0.2)
        for n in 25, 50, 100, 200:
            rows = self.steps(self.deck("worn_column", substeps=n))
            pressures, depth = recurrence(n)
            forces = [row["normal_force"] for row in rows]
            # The force of the last step is compared by the largest one, of which rounding is a share.
            values.add(n, "pressure in the end", computed=forces[-1]/AREA, reference=pressures[-1], allowed=ROUNDING*10)
            values.add(n, "depth", computed=rows[-1]["max_wear_depth"], reference=depth, allowed=ROUNDING)
            volume = WEAR*(WAY/n)*sum((a + b)/2 for a, b in zip(forces, forces[1:]))
            values.add(n, "volume", computed=rows[-1]["wear_volume_sole"], reference=volume, allowed=ROUNDING)
            # What the floor's work takes is strain energy, both ends of a step on a line between them.
            strain = AREA*HEIGHT*pressures[-1]**2/(2*YOUNG)
            values.add(n, "strain energy", computed=rows[-1]["strain_energy"], reference=strain, allowed=ROUNDING*10)
            self.assertLess(max(abs(row["energy_error"] - rows[0]["energy_error"]) for row in rows), 1e-15)
            exact = YOUNG*DELTA/HEIGHT*exp(-WEAR*YOUNG*WAY/HEIGHT)
            errors.add("steps", 1/n, forces[-1]/AREA/exact - 1)
        self.assert_table(values)
        errors.close()
        self.assert_table(errors)


if __name__ == "__main__":
    main()
