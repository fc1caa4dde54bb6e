#!/usr/bin/env python3
r"""Bolt diagram.

A bolt in a sleeve, both bars with $\nu = 0$ under one rigid head, is tightened by a force $F$ across a cut between
meshes that do not match, and locked. The cut has closed by $F/k_b + F/k_s$. A working load $P$ on the head is then
shared as the stiffnesses are, $F_b = F + P k_b/(k_b + k_s)$ and $F_s = F - P k_s/(k_b + k_s)$, exactly, with any two
kinds of elements on both sides of the cut. Without the lock the bolt would keep $F$.
"""
from benchmark import ELEMENTS, main
from convergence import RoundoffTable
from history_benchmark import HistoryBenchmark

BOLT, SLEEVE = 25.0, 15.0
FORCE, LOAD = 5.0, 3.0
SHORTENING = FORCE/BOLT + FORCE/SLEEVE


class BoltDiagram(HistoryBenchmark):
    """Springs in series and in parallel."""

    def test_every_pair_of_elements(self):
        table = RoundoffTable("Errors over the exact values", ["slave", "master"], ["bolt", "sleeve", "shortening"],
                              1e-11)
        for slave in ELEMENTS:
            for master in ELEMENTS:
                deck = self.deck("bolt_diagram").replace("'shank' ", f"'shank'  element = '{slave}'") \
                    .replace("'foot' ", f"'foot'  element = '{master}'")
                errors = [0.0, 0.0, 0.0]
                for row, load in zip(self.steps(deck)[1:], (0.0, LOAD, -LOAD)):
                    exact = (FORCE + load*BOLT/(BOLT + SLEEVE), FORCE - load*SLEEVE/(BOLT + SLEEVE), SHORTENING)
                    keys = "preload_bolt_force", "reaction_y_base", "preload_bolt_shortening"
                    errors = [max(error, abs(row[key]/value - 1)) for error, key, value in zip(errors, keys, exact)]
                table.add(slave, master, errors=errors)
        self.assert_table(table)


if __name__ == "__main__":
    main()
