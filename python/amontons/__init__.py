"""Plane contact with Coulomb friction, from Python: NumPy arrays in and out.

    import amontons
    result = amontons.solve_deck("bar.nml", "results")
    result.contact["contact_pressure"], result.summary["lengths"]

    result = amontons.solve_reduced(W, q, mu)       # u = W r + q
    result.r, result.u, result.status

    grid = amontons.read_grid("results/bar.vtu")
    grid.point_data["displacement"]

`amontons.plot` draws solved cases, `amontons.report` makes a page of them; both are commands too, amontons-plot and
amontons-report, or `python -m amontons plot`.
"""
import importlib

_SOLVE = ("AmontonsError", "DeckResult", "InputRefused", "NotConverged", "NumericalFailure", "ReducedResult",
          "SystemFailure", "set_threads", "solve_deck", "solve_reduced", "version")
_GRID = ("Grid", "read_grid")
__all__ = [*_GRID, *_SOLVE]


def __getattr__(name):
    """Loads NumPy and the library when they are first needed: the commands start without them."""
    if name == "__version__":
        return importlib.import_module("amontons.solve").version()
    for module, names in (("amontons.solve", _SOLVE), ("amontons.grid", _GRID)):
        if name in names:
            return getattr(importlib.import_module(module), name)
    raise AttributeError(f"module 'amontons' has no attribute '{name}'")


def __dir__():
    return sorted([*globals(), *__all__, "__version__"])
