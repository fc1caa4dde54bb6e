"""A body from arrays: the lower part of a rubber roller, whose hub comes down by 0.2 mm on a floor.

Usage: roller.py [DIRECTORY]
"""
# %% The mesh in polar coordinates: rings of quadrilaterals from the hub to the tread. Units: mm, N.
import sys
from pathlib import Path

import numpy as np

import amontons

HUB, TREAD = 20.0, 40.0
radius, angle = np.meshgrid(np.linspace(HUB, TREAD, 21), np.radians(np.linspace(-130, -50, 161)), indexing="ij")
nodes = np.column_stack([(radius*np.cos(angle)).ravel(), (radius*np.sin(angle)).ravel()])
number = np.arange(radius.size).reshape(radius.shape)
quadrilaterals = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
sides = {"hub": np.column_stack([number[0, :-1], number[0, 1:]]),
         "tread": np.column_stack([number[-1, :-1], number[-1, 1:]])}
mesh = amontons.Mesh(nodes, [("quad", quadrilaterals)], sides)

# %% Everything else is a deck.
DECK = """
&case name = 'roller'  title = 'Rubber roller on a floor'  units = 'mm, N, MPa' /
&material young = 5.0  poisson = 0.45 /
&support set = 'hub'  ux = 0.0  uy = -0.2 /
&contact set = 'tread'  friction = 0.5  point = 0.0, -40.0 /
"""
directory = Path(sys.argv[1] if len(sys.argv) > 1 else "results")
result = amontons.solve_deck(DECK, directory, mesh=mesh)
width = np.ptp(result.contact["x"][result.contact["status"] != "open"])
print(f"contact width {width:.3g} mm, force {result.contact['normal_force'].sum():.4g} N/mm")
amontons.figure(result, ["body", "detail", "stress", "slip"]).savefig(directory / "roller.png", dpi=150)
