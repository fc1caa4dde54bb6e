#!/usr/bin/env python3
r"""Bar on a rough support.

A bar of stiffness $EA$ lies on a support that resists sliding by $q$ per length, whatever the pressure, and is pulled
at one end. The force $F$ makes it slip over $F/q$; the end moves by $u = F^2/(2EAq)$, of the work done there
$F^3/(6EAq)$ is dissipated and as much stored. Unloaded, half of $u$ stays and half of the first slip is undone. A cycle
between $F$ and $-F$ dissipates $2F^3/(3EAq)$.

This is as every reversed branch is the first loading at twice its size (Masing). The bar is a strip in plane stress,
flat enough to be one-dimensional: shear across it changes $u$ by some $10^{-5}$. The slip zone ends within a cell, so
that errors fall with the square of the cells' length. Within a branch the bounds do not change and no point slips back:
any number of steps gives the same. Tolerances: $10^{-3}$ on 100 cells, $10^{-4}$ on 400.
"""
from benchmark import main
from convergence import ValueTable
from history_benchmark import HistoryBenchmark

STIFFNESS, SHEAR, FORCE = 1000.0, 2.0, 10.0
U = FORCE**2/(2*STIFFNESS*SHEAR)
W = 2*FORCE**3/(3*STIFFNESS*SHEAR)


class RoughBar(HistoryBenchmark):
    """Displacement of the end and dissipation."""

    def test_cycle(self):
        table = ValueTable("Displacement of the end and dissipation", ["cells", "steps of a branch", "quantity"])
        for cells, allowed in self.meshes(((100, 1e-3),), ((100, 1e-3), (200, 3e-4), (400, 1e-4))):
            for n in (1, 5):
                rows = self.steps(self.deck("rough_bar", cells=(cells, 1), substeps=n))
                pulled, unloaded, pushed, end = rows[n::n]
                labels = (cells, n)
                table.add(*labels, "u at F", computed=pulled["ux_1"], reference=U, allowed=allowed)
                table.add(*labels, "u back at 0", computed=unloaded["ux_1"], reference=U/2, allowed=allowed)
                table.add(*labels, "u at -F", computed=pushed["ux_1"], reference=-U, allowed=allowed)
                table.add(*labels, "slip length", computed=pulled["slip_length"], reference=FORCE/SHEAR,
                          allowed=2.0/cells)
                table.add(*labels, "dissipated at F", computed=pulled["dissipation"], reference=W/4, allowed=allowed)
                table.add(*labels, "dissipated on unloading", computed=unloaded["dissipation"] - pulled["dissipation"],
                          reference=W/16, allowed=allowed)
                table.add(*labels, "dissipated in the cycle", computed=end["dissipation"] - pulled["dissipation"],
                          reference=W, allowed=allowed)
        self.assert_table(table)


if __name__ == "__main__":
    main()
