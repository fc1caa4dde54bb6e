#!/usr/bin/env python3
r"""A part with a bore and fillets.

A lug of curved ten-node tetrahedra by Gmsh stands on a rough floor, and the pin in its bore pulls it aslant. A part of
the sole lifts off, and nearly all of the rest slips by some $10^{-5}$ mm. Statics say what the floor bears, and where.
Every tetrahedron is cut in eight: the stresses converge in the norm of the strain energy, with the order 1 that the
edge of the sole leaves, to those of meshes with 30 000 tetrahedra that were made anew.

The error of the stresses is $\sqrt{2(E - E_h)}$ over $\sqrt{2E}$ with the strain energy $E$ of the fine meshes, the
effectivity that of the program's estimate. Tolerance: 1e-4 of statics, since the faces of the bore are parabolas.
"""
import math
import shutil

from benchmark import DECKS, Benchmark, main
from convergence import ConvergenceTable, ValueTable

ENERGY = 0.098665
FORCES = {"contact_force_x": -150.0, "contact_force_y": -60.0, "contact_force_z": 600.0, "contact_centroid_x": 5.0,
          "contact_centroid_y": 2.0}


class SolidPart(Benchmark):
    """Equilibrium and convergence of a lug."""

    def test_lug(self):
        shutil.copy(DECKS/"solid_lug.msh", self.directory)
        values = ValueTable("Forces of the floor and their centre", ["refined", "quantity"])
        errors = ConvergenceTable("Stresses of the lug", ["stress"], {"tet10": (1,)})
        for refine in (0, 1):
            result = self.solve(self.deck("solid_lug", refine=refine))
            self.assert_sound(result)
            self.assertEqual(result.summary["warnings"], [])
            self.assertEqual(set(result["status"]), {"open", "slip", "stick"})
            for name, exact in FORCES.items():
                values.add(refine, name, computed=result.summary["key_results"][name], reference=exact, allowed=1e-4)
            energy = result.summary["certificate"]["strain_energy"]
            errors.add("tet10", 0.5**refine, math.sqrt(1 - energy/ENERGY),
                       effectivity=result.summary["accuracy"]["error_norm"]/math.sqrt(2*(ENERGY - energy)))
        errors.close()
        self.assert_table(values)
        self.assert_table(errors)


if __name__ == "__main__":
    main()
