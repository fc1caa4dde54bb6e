"""Wear that changes the surface: a block on a round floor, which wears until it is flat.

Usage: wear.py [DIRECTORY]

Archard: where the pressure is p the floor wears by the depth k p s over the sliding distance s. Each pass solves the
contact, wears the floor, and writes its profile for the next one. In the end the pressure is that on the block's top,
everywhere. Units: mm, N.
"""
import sys
from pathlib import Path

import numpy as np

import amontons

LENGTH, TOP_PRESSURE, CROWN = 20.0, 1.0, 0.1
WEAR = 8e-4    # depth per pressure in a pass, k s; if it is too large the pressures swing from pass to pass
directory = Path(sys.argv[1] if len(sys.argv) > 1 else "results").resolve()
directory.mkdir(parents=True, exist_ok=True)
line = directory / "floor.csv"
DECK = f"""
&case name = 'wear'  title = 'Block on a floor that wears' /
&mesh size = {LENGTH}, 10.0  cells = 20, 10 /
&material young = 1000.0  poisson = 0.3 /
&support set = 'left'  ux = 0.0 /
&load set = 'top'  pressure = {TOP_PRESSURE} /
&contact set = 'bottom'  obstacle = 'polyline'  line = '{line}'  gap_direction = 0.0, -1.0 /
"""

# %% Half of a floor with a crown, x = 0 the plane of symmetry: the depth below y = 0 at the nodes of the block.
x = np.linspace(0.0, LENGTH, 21)
depth = CROWN*(x/LENGTH)**2
worn = np.zeros_like(x)
for number in range(1, 251):
    stations, heights = np.r_[-1.0, x, LENGTH + 1.0], -np.r_[(depth + worn)[0], depth + worn, (depth + worn)[-1]]
    np.savetxt(line, np.column_stack([stations, heights]))
    contact = amontons.solve_deck(DECK, directory).contact
    if number == 1:
        print(f"new: {np.sum(contact['status'] != 'open')} of {x.size} points touch, "
              f"peak pressure {contact['contact_pressure'].max():.3f}")
    worn += WEAR*contact["contact_pressure"]
area = np.sum(contact["weight"]*worn)
print(f"after {number} passes: peak pressure {contact['contact_pressure'].max():.3f}, worn area {area:.5f}, "
      f"Archard's {WEAR*number*TOP_PRESSURE*LENGTH:.5f}")
