#!/usr/bin/env python3
"""The reference of decks: what --reference prints is what the reader does, and what doc/decks.md shows."""
import re
import sys
import unittest
from pathlib import Path

from harness import PROGRAM, ProgramTest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts" / "dev"
# A deck that is in order whichever one of its keys is left out, but for required ones.
GROUPS = {
    "mesh": {"size": "4.0, 2.0", "cells": "4, 2"},
    "material": {"young": "100.0", "poisson": "0.25"},
    "support": {"set": "'left'", "ux": "0.0", "uy": "0.0"},
    "load": {"name": "'push'", "set": "'top'", "pressure": "1.0", "traction": "0.0, -1.0"},
    "contact": {"set": "'bottom'", "friction": "0.3"},
}
# What a key goes with, where that is not what the group has above.
COMPANIONS = {
    ("sweep", "friction"): {},
    ("sweep", "friction_factor"): {},
    ("sweep", "count"): {"load": "'push'", "factor": "1.0, 2.0"},
    ("sweep", "combine"): {"load": "'push'", "factor": "1.0, 2.0"},
    ("contact", "radius"): {"set": "'bottom'", "obstacle": "'circle'"},
    **{("contact", key): {"set": "'bottom'", "against": "'below.top'"} for key in ("search", "gap")},
    ("contact", "cells"): {"set": "'bottom'", "multipliers": "'constant'"},
    ("contact", "cell_ends"): {"set": "'bottom'", "multipliers": "'constant'"},
    **{("tie", key): {"set": "'bottom'", "to": "'below.top'"} for key in ("set", "to", "search")},
    ("problem", "friction"): {"kind": "'reduced'", "file": "'none.dat'"},
    **{("history", key): {"times": "0.0, 1.0"}
       for key in ("times", "name", "substeps", "step_tolerance", "min_step", "cycles")},
    ("history", "period"): {"times": "0.0, 1.0", "cycles": "0.0"},
    ("history", "cycle_tolerance"): {"times": "0.0, 1.0", "cycles": "0.0, 1.0"},
    ("history", "start"): {"times": "0.0, 1.0"},
    ("history", "start_step"): {"times": "0.0, 1.0", "start": "'none.csv'"},
    **{("steps", key): {"load": "'push'", "factor": "1.0"} for key in ("load", "factor")},
    **{("steps", key): {"obstacle": "'bottom'", "shift_x": "0.0", "turn": "0.0"}
       for key in ("obstacle", "shift_x", "shift_y", "turn", "pivot")},
    ("steps", "friction_factor"): {"contact": "'bottom'"},
}
# What a deck needs besides, for a key to stand in it.
HISTORY = {"history": {"times": "0.0"}}
SECOND_BODY = {"mesh name = 'below'  size = 4.0, 2.0  cells = 3, 2  origin = 0.0, -2.0": {},
               "support set = 'below.bottom'  ux = 0.0  uy = 0.0": {}}
BESIDES = {
    ("contact", "search"): SECOND_BODY,
    ("contact", "gap"): SECOND_BODY,
    ("contact", "wear"): HISTORY,
    **{("tie", key): SECOND_BODY for key in ("set", "to", "search")},
    ("output", "fields_every"): {"sweep": {"friction": "0.1, 0.2"}},
    ("output", "key_results"): {"sweep": {"friction": "0.1, 0.2"}},
    ("output", "points_every"): HISTORY,
    ("output", "states_every"): HISTORY,
    ("output", "probe"): HISTORY,
    ("output", "fretting"): HISTORY,
    **{("steps", key): HISTORY for key in ("load", "factor", "obstacle", "shift_x", "shift_y", "turn", "pivot",
                                          "friction_factor")},
}
WORD = re.compile(r"`('[^`]*')`")
NOUNS = {"text": "quoted text", "number": "number", "numbers": "number", "whole": "whole number",
         "logical": "logical value"}


class Key:
    """A row of the reference."""

    def __init__(self, group, row):
        name, self.values, _, self.default, self.meaning = (cell.strip() for cell in row.strip("|").split("|"))
        self.group, self.name, self.is_required = group, name.strip("*`"), name.startswith("*")
        self.words = WORD.findall(self.values)
        n_values, in_space, noun = re.match(r"(\d+ )?(?:or (\d+ ))?(\w+)",
                                            "text" if self.words else self.values).groups()
        self.is_list = self.values.startswith(("numbers", "whole numbers", "texts"))
        self.n_values, self.noun = int(n_values or 1), NOUNS[noun]
        self.too_many = int(in_space or self.n_values) + 1

    def out_of_range(self):
        """The least values that the reference excludes."""
        numbers = re.findall(r"(?:above|below|not|not both) (-?[\d.]+)", self.values)
        numbers += [str(int(number) - 1) for number in re.findall(r"at least (\d+)", self.values)]
        return [f"{self.n_values}*{number}" for number in numbers]

    def in_range(self):
        """The least values that the reference includes."""
        return [f"{self.n_values}*{number}" for number in re.findall(r"at least (\d+)", self.values)]


class Reference(ProgramTest):
    """The table against the reader."""

    def setUp(self):
        super().setUp()
        self.groups = {}
        for line in self.run_program("--reference").stdout.splitlines():
            if line.startswith("### `&"):
                rows = self.groups.setdefault(line.split("`")[1][1:], [])
            elif line.startswith(("| `", "| **`")):
                rows.append(Key(list(self.groups)[-1], line))
        self.keys = [key for rows in self.groups.values() for key in rows]
        self.assertGreater(len(self.keys), 60)

    def faults(self, text):
        """The messages a deck is refused with."""
        return self.run_program("--check", self.write("deck.nml", text), status=1).stderr

    def deck(self, key, value=None):
        """A sound deck but for the value of one key, which is left out where there is none."""
        group = COMPANIONS.get((key.group, key.name), GROUPS.get(key.group, {}))
        groups = {**GROUPS, **BESIDES.get((key.group, key.name), {}),
                  key.group: {name: text for name, text in group.items() if name != key.name}}
        if value:
            groups[key.group][key.name] = value
        return "".join(f"&{group} {'  '.join(f'{name} = {text}' for name, text in values.items())} /\n"
                       for group, values in groups.items())

    def effective_deck(self, text):
        """The deck with all defaults that a run leaves."""
        self.run_program("--quiet", self.write("deck.nml", text))
        return self.contents()["deck.deck.nml"].decode()

    def test_groups_are_those_of_the_reader(self):
        groups = re.search(r"\(groups: (.*)\)", self.faults("&zzzzzzzz /"))[1]
        self.assertEqual(groups.split(", "), ["&" + group for group in self.groups])

    def test_groups_that_may_be_repeated_are_those_of_the_reader(self):
        heads = re.findall(r"^### `&(\w+)`(.*)$", self.run_program("--reference").stdout, re.MULTILINE)
        for group, remark in heads:
            once = "in line 1 already" in self.faults(f"&{group} /\n&{group} /\n&zzzzzzzz /")
            self.assertEqual(remark, "" if once else " (may be repeated)", group)

    def test_keys_are_those_of_the_reader(self):
        for group, rows in self.groups.items():
            keys = re.search(r"\(keys: (.*)\)", self.faults(f"&{group} zzzzzzzz = 1 /"))[1]
            self.assertEqual(sorted(keys.split(", ")), sorted(key.name for key in rows) or ["none"], group)

    def test_words_are_those_of_the_reader(self):
        for key in self.keys:
            faults = self.faults(f"&{key.group} {key.name} = 'zzzzzzzz' /\n&zzzzzzzz /")
            # A list of words may end with a hint at another key, in parentheses.
            words = re.search(rf"{key.name}: expected one of (.*?)(?: \(.*\))?, found", faults)
            self.assertEqual(words[1].split(", ") if words else [], key.words, key.name)

    def test_number_and_type_of_values_are_those_of_the_reader(self):
        for key in self.keys:
            if key.is_list:
                value, fault = ("1", f"{key.name}: expected one of {', '.join(key.words)}, found 1") if key.words else (
                    "'x'", f"{key.name}: expected a {key.noun}, found 'x'")
            else:
                value, fault = f"{key.too_many}*1", f"{key.name}: expected {key.n_values} {key.noun}" \
                    f"{'s' if key.n_values > 1 else ''}, found {key.too_many}"
            # Hints stand in parentheses.
            faults = re.sub(r" \([^)]*\), found", ", found", self.faults(f"&{key.group} {key.name} = {value} /"))
            self.assertIn(fault, faults)

    def test_ranges_are_those_of_the_reader(self):
        for key in self.keys:
            for value in key.out_of_range():
                with self.subTest(key=(key.group, key.name), value=value):
                    self.assertIn(f"{key.name} must ", self.faults(self.deck(key, value)))
            for value in key.in_range():
                if (key.group, key.name) in {("problem", "friction"), ("mesh", "step")}:
                    continue  # there is no file
                with self.subTest(key=(key.group, key.name), value=value):
                    self.run_program("--check", self.write("deck.nml", self.deck(key, value)))

    def test_defaults_are_those_of_the_reader(self):
        n_defaults = 0
        for key in self.keys:
            if not key.default.startswith("`"):
                continue
            with self.subTest(key=(key.group, key.name)):
                n_defaults += 1
                self.assertEqual(self.effective_deck(self.deck(key, key.default.strip("`"))),
                                 self.effective_deck(self.deck(key)))
        self.assertGreater(n_defaults, 20)

    def test_required_keys_are_required(self):
        for key in self.keys:
            if key.is_required:
                self.assertIn(f"&{key.group} needs ", self.faults(self.deck(key)))

    def test_every_key_has_a_meaning(self):
        for key in self.keys:
            self.assertGreater(len(key.meaning), 5, key.name)


class Printing(ProgramTest):
    """What the option prints, and where it is shown."""

    def test_groups_that_are_named_are_printed(self):
        text = self.run_program("--reference", "solver", "&Mesh").stdout
        self.assertEqual(re.findall("^### .*", text, re.MULTILINE), ["### `&solver`", "### `&mesh` (may be repeated)"])

    def test_group_that_is_unknown_is_refused(self):
        run = self.run_program("--reference", "mehs", status=1)
        self.assertEqual(run.stderr, "amontons: unknown group &mehs; did you mean &mesh?\n")
        self.assertEqual(run.stdout, "")

    def test_page_of_decks_shows_the_reference(self):
        run = self.run_command([sys.executable, "-B", str(SCRIPTS / "page_tables.py"), PROGRAM], None)
        self.assertEqual(run.stdout, "", "put it in place with scripts/dev/manual.sh --update")
        self.assertEqual(run.returncode, 0, run.stderr)


if __name__ == "__main__":
    unittest.main()
