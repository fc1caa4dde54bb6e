#!/usr/bin/env python3
"""Heated bodies.

A heated block expands freely without stress, or is restrained: along one direction, $\\sigma = -E \\alpha T$, over $1 -
\\nu$ in plane strain; along both, over $1 - \\nu$ in plane stress and over $1 - 2\\nu$ else. A beam that is heated
linearly over its height bends without stress. A plug that is heated in a rigid hole presses on it once its play is used
up. All of these displacements are in the space of the elements, at least of the quadratic ones, so they must be given
to rounding. A tube that is hot inside (Timoshenko and Goodier, *Theory of Elasticity*, article 151) has its
temperatures from a table.
"""
from math import hypot, log, pi

from benchmark import ELEMENTS, Benchmark, main
from convergence import ORDER_ALLOWANCE, ConvergenceTable, RoundoffTable
from field_error import Elastic, displacement_error, stress_error
from harness import read_vtu
from mapped_mesh import mapped_mesh, sector, wall

YOUNG, POISSON, EXPANSION = 200000.0, 0.3, 1.2e-5
STRAIN = 80.0*EXPANSION
HYPOTHESES = ("plane stress", "plane strain", "axisymmetric")
RIGHT, TOP = "&support set = 'right'  ux = 0.0 /\n", "&support set = 'top'  uy = 0.0 /\n"
# Some ten operations on numbers that cancel to a hundredth of themselves.
ROUNDING = 1e-12
INNER, OUTER = 1.0, 2.0


def block_stress(hypothesis, along_x, along_y):
    """The stresses xx, yy, zz of a block of Poisson's ratio 0.3 that may not expand along some directions."""
    thermal = YOUNG*STRAIN
    # In a body of revolution a restraint along the radius is one along the circumference, too.
    is_held = [along_x, along_y, hypothesis == "plane strain" or (hypothesis == "axisymmetric" and along_x)]
    stress = -thermal/(1 - POISSON*(sum(is_held) - 1)) if any(is_held) else 0.0
    return [stress*held for held in is_held]


def tube_temperature(r):
    """The temperature in the wall."""
    return 100.0*log(OUTER/r)/log(OUTER/INNER)


def tube_integral(r):
    """The integral of temperature times radius from the inner radius on."""
    def primitive(r):
        return 0.5*r**2*log(OUTER/r) + 0.25*r**2
    return 100.0/log(OUTER/INNER)*(primitive(r) - primitive(INNER))


def tube_displacement(r):
    """The radial displacement of the tube, in plane strain."""
    factor = 1e-4*(1 + POISSON)/(1 - POISSON)
    share = tube_integral(OUTER)/(OUTER**2 - INNER**2)
    return factor*(tube_integral(r)/r + share*((1 - 2*POISSON)*r + INNER**2/r))


def node_lines(mesh):
    """Numbers and coordinates of the nodes of a mesh file."""
    lines = mesh.splitlines()
    first = lines.index("$Nodes") + 2
    return [(int(number), float(x), float(y)) for number, x, y, _ in
            map(str.split, lines[first:lines.index("$EndNodes")])]


class Heating(Benchmark):
    """Thermal strain in every element, hypothesis and formulation."""

    def stresses(self):
        """The stresses xx, yy, xy, zz of all elements."""
        arrays, _, _ = read_vtu((self.directory/"case.vtu").read_bytes())
        return [[tensor[0], tensor[1], tensor[3], tensor[2]] for tensor in arrays["stress"]]

    def test_block(self):
        table = RoundoffTable("Block, free or held along x, along y or both", ["hypothesis", "element"],
                              ["displacement", "stress", "energy"], ROUNDING)
        for hypothesis in HYPOTHESES:
            for element in ELEMENTS:
                errors = [self.block_errors(hypothesis, element, held) for held in ("", RIGHT, TOP, RIGHT + TOP)]
                table.add(hypothesis, element, errors=list(map(max, zip(*errors))))
        self.assert_table(table)

    def block_errors(self, hypothesis, element, held):
        """Errors of displacement (of a free block), stress and strain energy, over those of full restraint."""
        result = self.solve(self.deck("heated_block", hypothesis=hypothesis, element=element) + held)
        self.assert_sound(result)
        exact = block_stress(hypothesis, RIGHT in held, TOP in held)
        scale = YOUNG*STRAIN
        stress = max(abs(found - wanted) for element_stress in self.stresses() for found, wanted in
                     zip(element_stress, (exact[0], exact[1], 0.0, exact[2])))/scale
        # Half of stress times elastic strain.
        density = (sum(s**2 for s in exact) - 2*POISSON*(exact[0]*exact[1] + exact[1]*exact[2] + exact[2]*exact[0]))
        volume = 8*pi/2 if hypothesis == "axisymmetric" else 2.0
        energy = abs(result.summary["certificate"]["strain_energy"]/volume - density/(2*YOUNG))/(scale*STRAIN)
        displacement = 0.0
        if not held:
            factor = STRAIN*(1 + POISSON if hypothesis == "plane strain" else 1)
            displacement = displacement_error(self.directory/"case.vtu", lambda x, y: (factor*x, factor*y))
        return displacement, stress, energy

    def test_nearly_incompressible_block(self):
        table = RoundoffTable("Block of Poisson's ratio 0.4999, B-bar, free", ["hypothesis"], ["displacement"], 1e-10)
        for hypothesis in HYPOTHESES[1:]:
            self.assert_sound(self.solve(self.deck("heated_block", hypothesis=hypothesis, poisson=0.4999)))
            factor = STRAIN*(1.4999 if hypothesis == "plane strain" else 1)
            error = displacement_error(self.directory/"case.vtu", lambda x, y, f=factor: (f*x, f*y))
            table.add(hypothesis, errors=[error])
        self.assert_table(table)

    def test_beam(self):
        exact = {element: [] for element in ELEMENTS}
        convergence = ConvergenceTable("Beam, linear elements", ["displacement"], {"tri3": (2,), "quad4": (2,)},
                                       allowance=self.meshes(0.2, ORDER_ALLOWANCE))
        rounding = RoundoffTable("Beam, quadratic elements", ["hypothesis", "element"], ["displacement", "stress"],
                                 1e-10)
        material = Elastic(YOUNG, POISSON, "plane stress", expansion=lambda x, y: EXPANSION*(20.0 + 20.0*y))
        for hypothesis, factor in (("plane stress", EXPANSION), ("plane strain", EXPANSION*(1 + POISSON))):
            def exact(x, y, a=factor):
                return a*(20.0 + 20.0*y)*x, a*(20.0*y + 10.0*(y**2 - x**2))
            for element in ELEMENTS[2:]:
                self.assert_sound(self.solve(self.deck("heated_beam", element=element, hypothesis=hypothesis)))
                stress = max(max(map(abs, tensor[:3])) for tensor in self.stresses())/(YOUNG*EXPANSION*60.0)
                rounding.add(hypothesis, element,
                             errors=[displacement_error(self.directory/"case.vtu", exact), stress])
            if hypothesis == "plane strain":
                continue
            for element in ELEMENTS[:2]:
                for cells in self.meshes((4, 8), (4, 8, 16, 32)):
                    result = self.solve(self.deck("heated_beam", element=element, cells=(2*cells, cells)))
                    self.assert_sound(result)
                    norm, _ = stress_error(self.directory/"case.vtu", exact, material)
                    convergence.add(element, 2.0/cells, displacement_error(self.directory/"case.vtu", exact),
                                    effectivity=result.summary["accuracy"]["error_norm"]/norm)
        convergence.close()
        self.assert_table(convergence)
        self.assert_table(rounding)

    def test_bimetal_strip(self):
        # Timoshenko's curvature of two layers that are bonded, m the ratio of their heights, n that of their moduli;
        # from the displacements of the lower side, away from the free end.
        m, n, height, heat = 1.0, 2.0, 2.0, 1e-5*50.0
        curvature = 6*heat*(1 + m)**2/(height*(3*(1 + m)**2 + (1 + m*n)*(m*m + 1/(m*n))))
        self.assert_sound(self.solve("""&mesh name = 'a'  size = 40.0, 1.0  cells = 80, 4  element = 'quad8' /
&mesh name = 'b'  size = 40.0, 1.0  cells = 80, 4  element = 'quad8'  origin = 0.0, 1.0 /
&material region = 'a'  young = 2e5  poisson = 0.3  hypothesis = 'plane stress'  expansion = 1e-5 /
&material region = 'b'  young = 1e5  poisson = 0.3  hypothesis = 'plane stress'  expansion = 2e-5 /
&tie set = 'a.top'  to = 'b.bottom' /
&load temperature = 50.0 /
&support set = 'a.left'  ux = 0.0 /
&support set = 'b.left'  ux = 0.0 /
&support point = 0.0, 0.0  uy = 0.0 /
"""))
        arrays, _, _ = read_vtu((self.directory/"case.vtu").read_bytes())
        deflection = {point[0]: moved[1] for point, moved in zip(arrays["points"], arrays["displacement"])
                      if abs(point[1]) < 1e-12}
        self.assertAlmostEqual(deflection[30.0]/(-0.5*curvature*30.0**2), 1.0, delta=1e-6)

    def test_ring_shrunk_on_a_rigid_shaft(self):
        # Lame's pressure of a ring that is as much too small as it shrinks, its ends free.
        shrinkage, ratio = 1e-4*100.0, (1.0 + 9.0)/(9.0 - 1.0)
        result = self.solve("""&mesh size = 2.0, 4.0  cells = 16, 16  element = 'quad8'  origin = 1.0, 0.0 /
&material young = 2000.0  poisson = 0.3  hypothesis = 'axisymmetric'  expansion = 1e-4 /
&load temperature = -100.0 /
&support set = 'bottom'  uy = 0.0 /
&contact set = 'left'  point = 1.0, 0.0  normal = 1.0, 0.0 /
""")
        self.assert_sound(result)
        self.assertAlmostEqual(sum(result["normal_force"])/(2*pi*4.0), 2000.0*shrinkage/(ratio + POISSON), delta=1e-3)

    def test_tube(self):
        self.study("Tube, plane strain", sector(INNER, OUTER, 0.5*pi), 2, lambda x, y: (
            tube_displacement(hypot(x, y))*x/hypot(x, y), tube_displacement(hypot(x, y))*y/hypot(x, y)))

    def test_tube_of_revolution(self):
        self.study("Tube, axisymmetric", wall(INNER, OUTER), 1, lambda r, z: (tube_displacement(r), 0.0),
                   is_axisymmetric=True)

    def study(self, caption, mapping, ratio, exact, is_axisymmetric=False):
        """Fills the table of the tube; `ratio` cells around or along for one through the wall."""
        material = Elastic(1000.0, POISSON, "axisymmetric" if is_axisymmetric else "plane strain",
                           expansion=lambda x, y: 1e-4*tube_temperature(x if is_axisymmetric else hypot(x, y)))

        def deck_of(element, cells):
            mesh = mapped_mesh((cells, ratio*cells), element, mapping)
            rows = [f"{number}, {tube_temperature(x if is_axisymmetric else hypot(x, y))!r}\n"
                    for number, x, y in node_lines(mesh)]
            self.write("heated_tube.csv", "node, temperature\n" + "".join(rows))
            deck = self.deck("heated_tube", mesh=mesh)
            return deck if not is_axisymmetric else deck.replace(
                "expansion", "hypothesis = 'axisymmetric'  expansion").replace("ux = 0.0", "uy = 0.0")

        self.study_elements(caption, deck_of, exact, material, OUTER - INNER, ((4, 8), (4, 8, 16, 32)))

    def test_plug(self):
        table = RoundoffTable("Plug in a rigid hole", ["element"], ["pressure", "stress"], ROUNDING)
        for element in ELEMENTS:
            result = self.solve(self.deck("heated_plug", element=element))
            self.assert_sound(result)
            strain = 100.0*EXPANSION
            pressure = YOUNG/((1 + POISSON)*(1 - 2*POISSON))*((1 + POISSON)*strain - 0.01/10.0)
            exact = (-pressure, -2*POISSON*pressure - YOUNG*strain, 0.0, -pressure)
            stress = max(abs(found - wanted) for tensor in self.stresses() for found, wanted in zip(tensor, exact))
            table.add(element, errors=[max(abs(p - pressure) for p in result["contact_pressure"])/pressure,
                                       stress/(YOUNG*strain)])
        self.assert_table(table)


if __name__ == "__main__":
    main()
