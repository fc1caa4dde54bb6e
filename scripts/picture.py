"""Draws a case: the deformed body with its von Mises stress, and below it forces and zones of the contact line.

Usage: picture.py DIRECTORY CASE IMAGE
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.collections import PolyCollection

# Okabe and Ito's colours, told apart by colour-blind readers too; a marker says the same once more.
ZONES = {"open": ("#D55E00", "o", "open"), "slip+": ("#0072B2", ">", "sliding to the right"),
         "slip-": ("#56B4E9", "<", "sliding to the left"), "stick": ("#009E73", "s", "sticking")}


def draw_body(axes, mesh, points):
    """The deformed mesh, coloured by von Mises stress, and its outline before."""
    displacement = mesh.point_data["displacement"][:, :2]
    magnification = 0.08 * np.ptp(mesh.points[:, :2], axis=0).max() / np.abs(displacement).max()
    moved = mesh.points[:, :2] + magnification * displacement
    cells = [moved[cell] for block in mesh.cells for cell in block.data]
    stress = np.concatenate(mesh.cell_data["von_mises"])
    drawn = axes.add_collection(PolyCollection(cells, array=stress, cmap="cividis", edgecolors="white", linewidths=0.2))
    low, high = mesh.points[:, :2].min(axis=0), mesh.points[:, :2].max(axis=0)
    axes.add_patch(plt.Rectangle(low, *(high - low), fill=False, linestyle="--", color="grey", linewidth=0.8))
    axes.axhline(low[1], color="black", linewidth=1.2)
    axes.fill_between([low[0] - 3, high[0] + 3], low[1] - 2, low[1], facecolor="0.85", hatch="////", edgecolor="0.6")
    node = {tuple(np.round(point[:2], 9)): moved[i] for i, point in enumerate(mesh.points)}
    for status, (color, marker, label) in ZONES.items():
        at = [node[round(float(p["x"]), 9), round(float(p["y"]), 9)] for p in points if p["status"] == status]
        if at:
            axes.plot(*np.transpose(at), linestyle="none", marker=marker, color=color, markersize=5, label=label)
    axes.set(aspect="equal", xlim=(low[0] - 3, high[0] + 3), ylim=(low[1] - 2, high[1] + 5), ylabel="y [mm]",
             title=f"displacements magnified {magnification:.0f} times")
    axes.legend(loc="upper center", ncols=3, frameon=False)
    return drawn


def draw_line(axes, points):
    """Normal and tangential stress along the contact line, and what friction could bear."""
    x = np.array([float(p["x"]) for p in points])
    normal = np.array([float(p["normal_stress"]) for p in points])
    tangential = np.array([float(p["tangential_stress"]) for p in points])
    axes.plot(x, normal, color="black", label="contact pressure")
    axes.plot(x, tangential, color="#CC79A7", linestyle="--", label="shear stress")
    for p, pressure in zip(points, normal):
        color, marker, _ = ZONES[p["status"]]
        axes.plot(float(p["x"]), pressure, marker=marker, color=color, markersize=4)
    axes.set(xlabel="x [mm]", ylabel="stress [daN/mm²]", xlim=(x.min() - 3, x.max() + 3),
             ylim=(None, 1.3 * normal.max()))
    axes.legend(loc="upper left", ncols=2, frameon=False)


def main(directory, case, image):
    stem = pathlib.Path(directory) / case
    mesh = meshio.read(f"{stem}.vtu")
    with open(f"{stem}.contact.csv", newline="") as table:
        points = list(csv.DictReader(table))
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7, 9), height_ratios=(2.6, 1), sharex=True,
                                         layout="constrained")
    figure.colorbar(draw_body(top, mesh, points), ax=top, label="von Mises stress [daN/mm²]", shrink=0.8)
    draw_line(bottom, points)
    figure.savefig(image, dpi=100, bbox_inches="tight")


if __name__ == "__main__":
    main(*sys.argv[1:4])
