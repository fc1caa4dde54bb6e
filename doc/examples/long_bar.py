"""Solves the long bar and draws it: the deformed body with its stress, contact stress and slip along its floor, and how
the stick zone grows with friction.

Usage: long_bar.py [DIRECTORY]. Runs as a script, or cell by cell (# %%) in an editor that knows notebooks.
"""
# %% The deck: half of a bar's section in mm and daN, pushed from the left, pressed from above, lying on a rough floor.
import sys
from pathlib import Path

import matplotlib.pyplot as plt

import amontons

DECK = {
    "case": {"name": "long_bar", "units": "mm, daN"},
    "mesh": {"size": (40.0, 40.0), "cells": (32, 10)},
    "material": {"young": 13000.0, "poisson": 0.2},
    "support": {"set": "right", "ux": 0.0},
    "load": [{"set": "left", "traction": (10.0, 0.0)}, {"set": "top", "traction": (0.0, -5.0)}],
    "contact": {"set": "bottom", "friction": 1.0},
}
directory = Path(sys.argv[1] if len(sys.argv) > 1 else "results")

# %% Its solution: tables and fields as arrays, the summary as a dict.
result = amontons.solve_deck(DECK, directory)
floor, lengths = result.contact, result.summary["lengths"]
print(f"{result.name}: {result.summary['iterations']} iterations, residual {result.summary['residual']:.1e}")
print(", ".join(f"{zone} {lengths[zone + '_length']:g} mm" for zone in ("open", "slip", "stick")))
print(f"largest pressure {floor['contact_pressure'].max():.4g} daN/mm², "
      f"largest displacement {abs(result.displacement).max():.3g} mm")

# %% A figure of the body and its floor.
figure = amontons.figure(result, ["body", "stress", "slip"], abscissa="x", size=(200, 90))
figure.savefig(directory / "long_bar.svg")
figure.savefig(directory / "long_bar.png", dpi=150)

# %% The same with other friction: settings take the place of what the deck says.
frictions = [0.2, 0.4, 0.6, 0.8, 1.0]
stick = [amontons.solve_deck(DECK, contact__friction=friction).summary["lengths"]["stick_length"]
         for friction in frictions]
figure, axes = plt.subplots(figsize=(4, 3), layout="constrained")
axes.plot(frictions, stick, marker="o")
axes.set(xlabel="friction", ylabel="stick length [mm]")
figure.savefig(directory / "friction.png", dpi=150)
