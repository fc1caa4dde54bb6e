#!/usr/bin/env python3
"""The decks of the benchmarks run as they stand."""
import unittest
from pathlib import Path

from harness import ProgramTest

HERE = Path(__file__).resolve().parent


class Decks(ProgramTest):
    """Every file in decks/."""

    def test_decks_are_solved(self):
        decks = sorted((HERE/"decks").glob("*.nml"))
        self.assertTrue(decks)
        self.run_program("--quiet", *decks)

    def test_decks_say_what_they_are(self):
        for deck in (HERE/"decks").glob("*.nml"):
            head = deck.read_text(encoding="utf-8").split("\n\n")[0]
            self.assertTrue(head.startswith("! "), deck.name)
            self.assertIn("Tolerance: ", head, deck.name)

    def test_benchmarks_are_named_once(self):
        named = (HERE/"benchmarks.txt").read_text(encoding="utf-8").split()
        found = [path.stem.removeprefix("test_") for path in HERE.glob("test_*.py")
                 if "\nfrom benchmark import" in path.read_text(encoding="utf-8")]
        self.assertEqual(sorted(named), sorted(found))


if __name__ == "__main__":
    unittest.main()
