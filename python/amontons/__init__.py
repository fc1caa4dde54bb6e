"""Contact with Coulomb friction, from Python: NumPy arrays in and out.

    import amontons
    result = amontons.solve_deck("bar.nml", contact__friction=0.3)  # or a text, or a dict of groups
    result.contact["contact_pressure"], result.displacement, result.summary["lengths"]
    amontons.figure(result, ["body", "stress"])

    result = amontons.solve_reduced(W, q, mu)       # u = W r + q
    result.r, result.u, result.status

    case = amontons.Case("results/bar")             # files of a solved case
    case.mesh.point_data["displacement"]

`figure` draws a case; the commands amontons-plot and amontons-report, or `python -m amontons plot`, draw files and make
a page of them.
"""
from __future__ import annotations

import importlib
from typing import Any

_NAMES = {
    "arguments": ("AmontonsError", "InputRefused"),
    "cases": ("Case",),
    "deck": ("deck_text", "read_deck"),
    "grid": ("Grid", "read_grid"),
    "mesh": ("Mesh",),
    "plot": ("figure",),
    "solve": ("ContactPoints", "DeckResult", "DoubtfulResult", "FileMissing", "NoEquilibrium", "NotConverged",
              "NumericalFailure", "ReducedResult", "StepState", "Stepper", "SystemFailure", "set_threads",
              "solve_deck", "solve_reduced", "version"),
}
__all__ = [name for names in _NAMES.values() for name in names]


def __getattr__(name: str) -> Any:
    """Loads NumPy and the library when they are first needed: the commands start without them."""
    if name == "__version__":
        return importlib.import_module("amontons.solve").version()
    for module, names in _NAMES.items():
        if name in names:
            return getattr(importlib.import_module(f"amontons.{module}"), name)
    raise AttributeError(f"module 'amontons' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__, "__version__"])
