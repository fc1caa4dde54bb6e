"""Solves the long bar and draws it: the deformed body with its stress, and pressure and shear along its floor.

Usage: long_bar.py [DIRECTORY]. Runs as a script, or cell by cell (# %%) in an editor that knows notebooks.
"""
# %% The deck: half of a bar's section in mm and daN, pushed from the left, pressed from above, lying on a rough floor.
import sys
from pathlib import Path

import matplotlib.pyplot as plt

import amontons

DECK = """
&case name = 'long_bar' /
&mesh size = 40.0, 40.0  cells = 32, 10 /
&material young = 13000.0  poisson = 0.2 /
&support set = 'right'  ux = 0.0 /
&load set = 'left'  traction = 10.0, 0.0 /
&load set = 'top'   traction = 0.0, -5.0 /
&contact set = 'bottom'  friction = 1.0 /
"""
FRICTION = 1.0
directory = Path(sys.argv[1] if len(sys.argv) > 1 else "results")
directory.mkdir(parents=True, exist_ok=True)
deck = directory / "long_bar_deck.nml"
deck.write_text(DECK, encoding="utf-8")

# %% Its solution: the contact table as arrays, the summary as a dict.
result = amontons.solve_deck(deck, directory)
floor, lengths = result.contact, result.summary["lengths"]
print(f"{result.name}: {result.summary['iterations']} iterations, residual {result.summary['residual']:.1e}")
print(", ".join(f"{zone} {lengths[zone + '_length']:g} mm" for zone in ("open", "slip", "stick")))

# %% The body, its displacements exaggerated.
SCALE = 200
mesh = amontons.read_grid(directory / "long_bar.vtu")
place = mesh.points[:, :2] + SCALE*mesh.point_data["displacement"][:, :2]
(_, quadrilaterals), = mesh.cells
figure, (body, line) = plt.subplots(2, 1, figsize=(7, 9), height_ratios=(3, 2), layout="constrained")
cells = plt.matplotlib.collections.PolyCollection(place[quadrilaterals], array=mesh.cell_data["von_mises"],
                                                  cmap="viridis", edgecolors="white", linewidths=0.2)
body.add_collection(cells)
body.axhline(0, color="black")
body.set(title=f"Displacements times {SCALE}", xlabel="x [mm]", ylabel="y [mm]")
body.autoscale()
body.set_aspect("equal")
figure.colorbar(cells, label="von Mises stress [daN/mm²]", ax=body)

# %% The floor: the shear stays within the friction bound, and reaches it where the bar slides.
bound = FRICTION*floor["contact_pressure"]
line.fill_between(floor["x"], -bound, bound, color="0.9", label="friction bound")
line.plot(floor["x"], floor["contact_pressure"], color="#0072b2", linewidth=4, label="pressure")
line.plot(floor["x"], floor["contact_shear"], color="#d55e00", label="shear")
for status, marker in (("open", "o"), ("slip+", ">"), ("slip-", "<"), ("stick", "s")):
    here = floor["status"] == status
    if here.any():
        line.plot(floor["x"][here], 0*floor["x"][here], marker, color="black", markersize=3, label=status)
line.set(xlabel="x [mm]", ylabel="stress [daN/mm²]")
line.legend(ncols=3)

# %% The picture.
figure.savefig(directory / "long_bar.svg")
figure.savefig(directory / "long_bar.png", dpi=150)
