"""Wear by a law of one's own: a block on a round floor, which wears until it is flat.

Where the pressure is p a pass wears the floor by the depth k s p (Archard; his law is also the key `wear` of a deck with
&history). Any other law may stand in the loop: each step is given the gaps that the law has left. In the end the
pressure is that on the block's top, everywhere. Units: mm, N.
"""
import numpy as np

import amontons

LENGTH, TOP_PRESSURE, CROWN = 20.0, 1.0, 0.1
WEAR = 8e-4    # depth per pressure in a pass, k s; if it is too large the pressures swing from pass to pass
DECK = f"""
&case title = 'Block on a floor that wears' /
&mesh size = {LENGTH}, 10.0  cells = 20, 10 /
&material young = 1000.0  poisson = 0.3 /
&support set = 'left'  ux = 0.0 /
&load set = 'top'  pressure = {TOP_PRESSURE} /
&contact set = 'bottom' /
&history times = 0.0 /
"""

# %% Half of a floor with a crown, x = 0 the plane of symmetry: its depth below y = 0 is a gap at each contact point.
stepper = amontons.Stepper(DECK)
points = stepper.points
worn = np.zeros_like(points.x)
state = stepper.rest()
for number in range(1, 251):
    state = stepper.step(state, number, gap=CROWN*(points.x/LENGTH)**2 + worn)
    pressure = state.normal_force/points.area
    if number == 1:
        print(f"new: {np.sum(state.status != 'open')} of {stepper.n_points} points touch, "
              f"peak pressure {pressure.max():.3f}")
    worn += WEAR*pressure
print(f"after {number} passes: peak pressure {pressure.max():.3f}, worn area {points.weight @ worn:.5f}, "
      f"Archard's {WEAR*number*TOP_PRESSURE*LENGTH:.5f}")
