"""Benchmarks of load histories: the tables of their steps."""
import csv

from benchmark import Benchmark


class HistoryBenchmark(Benchmark):
    """Solves decks with &history."""

    def steps(self, deck):
        """Solves a deck; the rows of its steps."""
        self.assert_sound(self.solve(deck))
        # Residuals below 1e-10, times what a stiff strip makes of them.
        self.assertLess(self.result("case").summary["load_history"]["energy_identities"], 1e-8)
        return self.rows("history")

    def rows(self, kind):
        """The rows of a table of the case, numbers as such."""
        with open(self.directory/f"case.{kind}.csv", newline="", encoding="utf-8") as file:
            return [{key: text if key in ("status", "statuses") else float(text) for key, text in row.items()}
                    for row in csv.DictReader(file)]
