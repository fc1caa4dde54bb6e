#!/usr/bin/env python3
"""Bodies of orthotropic materials: closed forms, turned frames, what is refused."""
import math
import unittest

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block

WOOD = "young = 140e3, 10e3, 8e3  poisson = 0.3, 0.25, 0.45  shear = 5e3"


class Orthotropic(ProgramTest):
    """Numbers that follow from the nine constants."""

    def solve(self, text):
        """Solves a deck and verifies its files."""
        self.write("case.nml", text)
        self.run_program("--output", "out", "case.nml")
        self.run_program("--verify", "out")
        return self.result("case", "out")

    def test_ring_under_pressure(self):
        # Lekhnitskii, Anisotropic Plates, section 26, in plane strain: u = A r^k + B r^-k with k^2 = D_hoop/D_radial.
        radial, axial, hoop = young = (10e3, 8e3, 90e3)
        nu_ra, nu_rh, nu_ah = 0.3, 0.05, 0.04
        ring = self.solve(block(
            "support set = 'bottom'  uy = 0.0", "support set = 'top'  uy = 0.0", "load set = 'left'  pressure = 2.0",
            "contact set = 'right'  normal = -1.0, 0.0  point = 9.0, 0.0",
            mesh="size = 1.0, 0.1  origin = 1.0, 0.0  cells = 60, 2  element = 'quad8'",
            material=f"hypothesis = 'axisymmetric'  young = {young[0]}, {young[1]}, {young[2]}  "
                     f"poisson = {nu_ra}, {nu_rh}, {nu_ah}  shear = 4e3"))
        # The law of (radial, hoop) without axial strain is the inverse of their compliance in plane strain.
        rr = 1/radial - nu_ra**2*axial/radial**2
        hh = 1/hoop - nu_ah**2*axial/axial**2
        rh = -nu_rh/radial - nu_ra/radial*axial*nu_ah/axial
        determinant = rr*hh - rh**2
        d_rr, d_hh, d_rh = hh/determinant, rr/determinant, -rh/determinant
        k = math.sqrt(d_hh/d_rr)
        # The stress d_rr u' + d_rh u/r is -2 at r = 1 and 0 at r = 2.
        plus, minus = d_rr*k + d_rh, -d_rr*k + d_rh
        b = -2.0/(minus - plus*2.0**(-k - 1)*minus/(plus*2.0**(k - 1)))
        a = -b*2.0**(-k - 1)*minus/(plus*2.0**(k - 1))
        largest = ring.summary["key_results"]["max_displacement"]
        # The error of 60 quadratic elements.
        self.assertAlmostEqual(largest, a + b, delta=1e-7*largest)

    def test_free_expansion(self):
        material = f"{WOOD}  expansion = -1e-6, 30e-6, 40e-6  angle = 30.0"
        result = self.solve(block(
            "support point = 0.0, 0.0  ux = 0.0  uy = 0.0", "support point = 4.0, 0.0  uy = 0.0",
            "load temperature = 50.0", "contact set = 'bottom'  point = 0.0, -1.0",
            material=f"{material}  hypothesis = 'plane stress'"))
        c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
        xx, yy = 50*(-1e-6*c*c + 30e-6*s*s), 50*(-1e-6*s*s + 30e-6*c*c)
        xy = 50*2*c*s*(-1e-6 - 30e-6)
        corners = [math.hypot(xx*x + xy*y, yy*y) for x, y in ((4, 0), (4, 2), (0, 2))]
        self.assertAlmostEqual(result.summary["key_results"]["max_displacement"], max(corners), delta=1e-12)
        # Rounding of stresses of 1, which 10e3 times 1e-4 would be.
        self.assertLess(result.summary["key_results"]["max_von_mises"], 1e-9)

    def test_axes_exchanged(self):
        # Axis 1 along y with its constants is axis 2 along x: nu21 = nu12 E2/E1, nu13 and nu23 trade places.
        groups = (SUPPORT, PRESSURE, "load set = 'right'  traction = 0.4, 0.0", CONTACT)
        turned = self.solve(block(*groups, material=f"{WOOD}  angle = 90.0"))
        exchanged = self.solve(block(*groups, material="young = 10e3, 140e3, 8e3  "
                                     f"poisson = {0.3*10e3/140e3}, 0.45, 0.25  shear = 5e3"))
        self.assertEqual(turned["status"], exchanged["status"])
        for one, other in zip(turned.forces, exchanged.forces):
            # Forces of 1, solved twice with condition 1e5.
            self.assertAlmostEqual(one, other, delta=1e-10)

    def test_history_with_stresses_of_the_surface(self):
        self.write("case.nml", block(
            SUPPORT, CONTACT, "load name = 'press'  set = 'top'  pressure = 1.0",
            "load name = 'pull'  set = 'right'  traction = 1.0, 0.0",
            "history times = 0.0, 1.0, 2.0, 3.0  cycles = 1.0, 3.0",
            "steps load = 'press'  factor = 0.0, 1.0, 1.0, 1.0",
            "steps load = 'pull'  factor = 0.0, 0.0, 0.3, 0.0", "output fretting = 'parameters'",
            material=f"{WOOD}  angle = 20.0"))
        self.run_program("--output", "out", "case.nml")
        self.run_program("--verify", "out")

    def test_constants_at_the_limit_of_positive_definiteness_are_refused_in_any_unit(self):
        # The sign of a pivot, which is 0, decided: some were refused, others solved or singular.
        for young in (1.0, 3.0, 0.3, 123.4, 1000.0, 210000.0):
            for poisson in ("0.5, 0.5, 0.5", "1.0, 0.0, 0.0", "0.0, 1.0, 0.0", "0.0, 0.0, 1.0", "0.8, 0.6, 0.0",
                            "0.6, 0.0, 0.8"):
                with self.subTest(young=young, poisson=poisson):
                    self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, material=(
                        f"young = {young}, {young}, {young}  poisson = {poisson}  shear = {young/2}")))
                    run = self.run_program("--check", "case.nml", status=1)
                    self.assertIn("the elastic constants are not positive definite", run.stderr)

    def test_refusals(self):
        for material, message in (
                ("young = 1.0, 2.0  poisson = 0.3", "young: expected 1 number or 3, found 2"),
                ("young = 1.0, 2.0, 3.0  poisson = 0.3  shear = 1.0", "poisson must have as many numbers as young"),
                ("young = 1.0, 2.0, 3.0  poisson = 0.1, 0.1, 0.1", "three numbers in young need shear"),
                ("young = 1.0  poisson = 0.3  shear = 1.0", "shear is only for three numbers in young"),
                ("young = 1.0  poisson = 0.3  expansion = 1.0, 2.0, 3.0", "expansion must be one number, or as many"),
                (f"{WOOD}  formulation = 'b-bar'", "formulation must not be 'b-bar' with an orthotropic material"),
                ("young = 1.0, 2.0, 3.0  poisson = 0.9, 0.1, 0.1  shear = 1.0",
                 "the elastic constants are not positive definite")):
            with self.subTest(material=material):
                self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, material=material))
                run = self.run_program("--check", "case.nml", status=1)
                self.assertRegex(run.stderr, rf"^case\.nml:2: {message}")
        self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, material=WOOD.replace("5e3", "-5e3")))
        run = self.run_program("--check", "case.nml", status=1)
        self.assertEqual(run.stderr, "case.nml:2: shear must be above 0, found -5000.0\n")


if __name__ == "__main__":
    unittest.main()
