"""The files of solved cases: finds them, and reads each when it is first asked for."""
from __future__ import annotations

import csv
import json
import os
import re
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import Any, Union

from amontons.deck import read_deck
from amontons.grid import Grid, part, read_grid

SUMMARY = ".summary.json"
ENDINGS = (SUMMARY, ".contact.csv", ".contact.vtu", ".sweep.csv", ".sweep.pvd", ".deck.nml", ".vtu", ".lst")
# What numbers are measured in, in length L and force F, by what their names begin with or contain; the first that fits.
DIMENSIONS = tuple((re.compile(pattern), dimension) for pattern, dimension in (
    ("^(reaction|force|tie)_(moment|torque)_", "F L"), ("^(reaction|force|tie)_([xyz]|normal|tangential)_", "F"),
    ("^factor_|^friction", ""), ("_area$", "L²"), ("strain_energy_density|pressure|shear|stress|mises|swt$", "F/L²"),
    ("error_norm", "√(F L)"), ("moment|torque|work_|energy|dissipation|closing_loss", "F L"), ("force", "F"),
    ("ruiz_2", "F²/L³"), ("ruiz_1|wear_integral", "F/L"), ("wear_volume", "L³"), ("wear_depth", "L"),
    ("_length|_width|centroid|displacement|slip|gap|^shift_|^u([xyz]|theta)_|^rigid_.*_u[xyz]$|shortening$|jump", "L"),
    ("", "")))


def dimension_of(name: str) -> str:
    """The dimension of a number or field by its name, as `Case.unit` takes it; empty if it has none."""
    return next(dimension for pattern, dimension in DIMENSIONS if pattern.search(name))


class CaseFault(ValueError):
    """What is wrong with the files of a case, in a sentence."""


def find_cases(names: Iterable[Union[str, os.PathLike[str]]]) -> list[str]:
    """The paths of the cases that names stand for, without the endings of their files: a folder of cases, any file of
    a case, or the path itself."""
    paths: list[str] = []
    for name in map(str, names):
        if Path(name).is_dir():
            found = sorted(str(path)[: -len(SUMMARY)] for path in Path(name).glob("*" + SUMMARY))
        else:
            stems = [name[: -len(ending)] for ending in ENDINGS if name.endswith(ending)] + [name]
            found = [stem for stem in stems if Path(stem + SUMMARY).exists()][:1]
        if not found:
            raise CaseFault(f"{name}: no case found; expected a folder with *{SUMMARY}, or a file of a case")
        paths += found
    return paths


class Case:
    """A case that is solved."""

    def __init__(self, path: Union[str, os.PathLike[str]]) -> None:
        self.path: str = str(path)  # of its files, without their endings
        try:
            self.summary: dict[str, Any] = json.loads(Path(self.path + SUMMARY).read_text(encoding="utf-8"))
        except ValueError:
            raise CaseFault(f"{self.path}{SUMMARY}: damaged: not JSON") from None

    @property
    def heading(self) -> str:
        """Its title, or its name where it has none."""
        return str(self.summary.get("title") or self.summary["case"])

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.summary['case']!r}: {self.summary['outcome'].replace('_', ' ')}>"

    @property
    def key_results(self) -> dict[str, float]:
        """The key results by name, each with its place; empty without a state, and of a sweep, which has extremes."""
        return dict(self.summary.get("key_results", {}))

    @property
    def has_state(self) -> bool:
        """Whether there is a state to show; else, without equilibrium or where a history has no first step, its summary
        has a message and no numbers."""
        return "message" not in self.summary

    @property
    def is_history(self) -> bool:
        """Whether it is the last step of a load history."""
        return "load_history" in self.summary

    @property
    def has_steps(self) -> bool:
        """Whether it is a load history that took steps: one that starts at its last time has none."""
        return self.is_history and bool(self.table("history"))

    @property
    def kind(self) -> str:
        """What it is: 'body', 'sweep' or 'reduced'."""
        return next((kind for kind, key in (("sweep", "sweep"), ("reduced", "problem")) if key in self.summary), "body")

    @property
    def is_solid(self) -> bool:
        """Whether it is a body in space."""
        return self.kind == "body" and self.mesh.is_solid

    @cached_property
    def mesh(self) -> Grid:
        """The body, NAME.vtu."""
        return read_grid(self.path + ".vtu")

    @cached_property
    def line(self) -> Grid:
        """The contact points, NAME.contact.vtu without the masters of pairs."""
        return part(self.contact_grid, self.contact_grid.point_data["status"] > 0)

    @cached_property
    def master(self) -> Grid:
        """The lines of the masters of pairs, the rest of NAME.contact.vtu."""
        return part(self.contact_grid, self.contact_grid.point_data["status"] == 0)

    @cached_property
    def contact_grid(self) -> Grid:
        """NAME.contact.vtu."""
        return read_grid(self.path + ".contact.vtu")

    @cached_property
    def contacts(self) -> list[dict[str, Any]]:
        """The groups `&contact` of its deck, those of the contact sets 1, 2, ...; none if pairs of a mesh file are
        before them."""
        is_from_file = any("contact" in mesh.get("use", ()) for mesh in self.groups("mesh"))
        return [] if is_from_file else self.groups("contact")

    def groups(self, name: str) -> list[dict[str, Any]]:
        """The groups of a name in its deck."""
        return [keys for group, keys in self.deck if group == name]

    @cached_property
    def deck(self) -> list[tuple[str, dict[str, Any]]]:
        """The groups of its effective deck."""
        return read_deck(Path(self.path + ".deck.nml").read_text(encoding="utf-8"))

    def table(self, name: str) -> list[dict[str, str]]:
        """The rows of a table, NAME.contact.csv or NAME.sweep.csv."""
        with open(f"{self.path}.{name}.csv", newline="", encoding="utf-8") as text:
            return list(csv.DictReader(text))

    def unit(self, dimension: str) -> str:
        """The unit of a dimension in length L and force F; empty where the deck names no units."""
        units = [unit.strip() for unit in (self.summary.get("units") or "").split(",") if unit.strip()]
        if not units:
            return ""
        if dimension == "F/L²" and len(units) > 2:
            return units[2]
        return dimension.translate({ord("L"): units[0], ord("F"): units[1]})

    def label(self, text: str, dimension: str = "") -> str:
        """A text for an axis, with the unit that the deck names for the dimension."""
        unit = self.unit(dimension)
        return f"{text} [{unit}]" if unit else text
