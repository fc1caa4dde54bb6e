#!/usr/bin/env python3
r"""Patch tests in space: pressure, stick and slip.

A block under a uniform stress with shear on its rough floor. Where the shear is less than the friction coefficient
times the pressure every point sticks; in the twin it is as large, its top is moved, and every point slips aslant. All
displacements are linear, so every element must give pressure, shear and displacement to rounding: on even meshes, with
nodes moved at random, and with edges and faces curved, those on the floor in their plane. Two such blocks on each
other, whose meshes do not match, have the same stress through the contact or the tie between them.

Errors of the stresses are the largest, over the pressure, those of the displacement over the largest one. Tolerances:
rounding; between faces of `hex20` at random places, whose functions are no polynomials of the plane, the rule of the
mortar integrals leaves some 1e-9. The edges of faces that meet are straight: integrals are over their polygons.
"""
import itertools
import random
import re

from harness import read_vtu

from benchmark import SOLIDS, Benchmark, main
from convergence import RoundoffTable
from mapped_solid import mapped_solid

SIZE, PRESSURE = (1.2, 1.0, 0.8), 2.0
# Deck, status, shear, displacement.
TWINS = (("solid_patch", "stick", 0.3, lambda z: (0.000576*z, -0.000432*z, -0.0018*z)),
         ("solid_slip_patch", "slip", 0.5, lambda z: (0.008 + 0.00096*z, -0.006 - 0.00072*z, -0.0018*z)))
# By how much nodes inside are moved, over a cell, and whether edges remain straight.
SHAPES = {"even": (0.0, True), "distorted": (0.15, True), "curved": (0.05, False)}


def block(element, cells, shape, seed, lowest=0.0, is_flat=False):
    """A block whose nodes inside of the body, its faces and edges are moved along these. Those of a flat one are not
    curved at bottom and top."""
    amount, is_straight = SHAPES[shape]
    rng, moved = random.Random(seed), {}

    def corner(index):
        # In half cells.
        if index not in moved:
            moved[index] = [size*(k/(2*n) + (amount*rng.uniform(-1, 1)/n if 0 < k < 2*n else 0.0))
                            for size, k, n in zip(SIZE, index, cells)]
        return moved[index]

    def place(*point):
        index = [round(2*n*x) for n, x in zip(cells, point)]
        ends = [corner(tuple(index))]
        if is_straight or is_flat and index[2] in (0, 2*cells[2]):
            # Edges of tetrahedra go from the lower to the higher corner.
            ends = [corner(tuple(2*((k + up)//2) for k in index)) for up in (0, 1)]
        x, y, z = (sum(values)/len(ends) for values in zip(*ends))
        return x, y, z + lowest
    return mapped_solid(cells, element, place)


class SolidPatch(Benchmark):
    """Uniform stress in solids."""

    def errors(self, deck, exact):
        """The error of the displacement of a case over the largest one, with its result."""
        result = self.solve(deck)
        self.assert_sound(result)
        arrays, *_ = read_vtu((self.directory/"case.vtu").read_bytes())
        moved = max(abs(found - right) for place, u in zip(arrays["points"], arrays["displacement"])
                    for found, right in zip(u, exact(place[2])))
        return moved/max(map(abs, exact(SIZE[2]))), result

    def test_floor(self):
        table = RoundoffTable("On a floor", ["case", "element", "mesh"],
                              ["pressure", "shear", "displacement"], 1e-11)
        for (name, status, shear, exact), element, shape in itertools.product(TWINS, SOLIDS, SHAPES):
            mesh = block(element, self.meshes((3, 3, 2), (6, 5, 4)), shape, 3)
            moved, result = self.errors(self.deck(name, mesh=mesh), exact)
            self.assertEqual(set(result["status"]), {status}, f"{name}, {element}, {shape}")
            table.add(status, element, shape, errors=[*stress_errors(result, shear), moved])
        self.assert_table(table)

    def test_blocks(self):
        table = RoundoffTable("Between two blocks",
                              ["relation", "upper", "lower", "mesh", "slave"], ["pressure", "shear", "displacement"],
                              1e-8)
        _, _, shear, exact = TWINS[0]
        deck = re.sub(r"&mesh.*\n", "", self.deck("solid_patch_pair"))
        for (upper, lower), shape in itertools.product(itertools.product(SOLIDS, SOLIDS), SHAPES):
            if not self.is_printing and (SOLIDS.index(upper) + SOLIDS.index(lower)) % 3:
                continue
            self.write("low.msh", block(lower, (2, 4, 2), shape, 3, -SIZE[2], is_flat=True))
            self.write("high.msh", block(upper, (3, 3, 2), shape, 5, is_flat=True))
            meshes = "".join(f"&mesh name = '{name}'  file = '{name}.msh' /\n" for name in ("low", "high"))
            for roles in (("high.bottom", "low.top"), ("low.top", "high.bottom")):
                for relation in ("contact", "tie"):
                    line = "&contact set = '{}'  against = '{}'  friction = 0.25 /" if relation == "contact" else \
                        "&tie set = '{}'  to = '{}' /"
                    moved, result = self.errors(meshes + re.sub("&contact.*/", line.format(*roles), deck), exact)
                    errors = stress_errors(result, shear) if relation == "contact" else (0.0, 0.0)
                    table.add(relation, upper, lower, shape, roles[0].split(".")[0], errors=[*errors, moved])
        self.assert_table(table)


def stress_errors(result, shear):
    """The errors of pressure and shear at the contact points."""
    return [max(abs(found - right) for found in result[name])/PRESSURE
            for name, right in (("contact_pressure", PRESSURE), ("contact_shear", shear))]


if __name__ == "__main__":
    main()
