#!/usr/bin/env python3
"""Sound cases in which rounding is all that is left of forces, strains or gaps: the certificate passes."""
import json
import unittest
from math import cos, pi, sin, tan

from mapped_mesh import mapped_mesh
from verification import Verification

# A stack on a floor, pressed and released.
STACK = """&mesh name = 'low'  size = 4.0, 1.0  cells = 8, 3 /
&mesh name = 'high'  size = 3.0, 1.0  cells = 5, 3  origin = 0.5, 1.0 /
&material young = 1000.0  poisson = 0.3 /
&load name = 'press'  set = 'high.top'  pressure = 1.0 /
&contact set = 'low.bottom'  friction = 0.3 /
&contact set = 'high.bottom'  against = 'low.top'  friction = 0.5 /
&history times = 0.0, 1.0, 2.0  substeps = 4 /
&steps load = 'press'  factor = 0.0, 1.0, 0.0 /
"""
# Two bonded blocks that fall on a floor, pressed by their weight, of which a part in 1e9 is left at the end.
FALLEN = """&mesh name = 'low'  size = 5.6, 1.19  cells = 24, 6  element = 'tri3' /
&mesh name = 'high'  size = 3.5, 1.5  cells = 15, 4  origin = 0.92, 1.19  element = 'quad9' /
&material young = 1200.0  poisson = 0.0  region = 'low' /
&material young = 5700.0  poisson = 0.0  region = 'high' /
&contact set = 'low.bottom'  friction = 0.3  point = 0.0, -0.0021 /
&tie set = 'low.top'  to = 'high.bottom' /
&load name = 'weight'  body_force = 0.0, -7.6 /
&history times = 0.0, 1.0, 2.0  substeps = 4 /
&steps load = 'weight'  factor = 0.7, 0.6, 1e-9 /
"""

# A block that overlaps another one by little, without loads at first.
OVERLAPPING = """&mesh name = 'low'  size = 4.0, 1.5  cells = 5, 2  element = 'tri3' /
&mesh name = 'high'  size = 3.0, 1.2  cells = 4, 3  element = 'quad8'  origin = {shift}, {height!r} /
&material young = 1000.0  poisson = 0.3 /
&{held} /
&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /
&load name = 'press'  set = 'high.top'  traction = 0.0, -0.01 /
&history times = 0.0, 1.0, 2.0, 3.0 /
&steps load = 'press'  factor = 0.0, 0.0, 1.0, 0.0 /
"""

# A soft block between two stiff ones, of which a support moves the upper one.
PRESSED = """&mesh name = 'low'  size = 10.0, 5.0  cells = 40, 20 /
&mesh name = 'soft'  size = 9.0, 5.0  cells = 36, 20  origin = 0.5, 5.0 /
&mesh name = 'high'  size = 10.0, 5.0  cells = 40, 20  origin = 0.0, 10.0 /
&material young = {stiff}  poisson = 0.3  region = 'low' /
&material young = 1.0  poisson = 0.499  formulation = 'b-bar'  region = 'soft' /
&material young = {stiff}  poisson = 0.3  region = 'high' /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'high.top'  ux = 0.0  uy = -0.5 /
&contact set = 'soft.top'  against = 'high.bottom'  friction = 0.3 /
&contact set = 'soft.bottom'  against = 'low.top'  friction = 0.3 /
"""

# A stiff block on two soft ones, held by contact or a tie alone.
LOOSE = """&mesh name = 'low'  size = 2.1, 1.1  cells = 13, 4  element = 'tri3' /
&mesh name = 'mid'  size = 1.4, 2.0  cells = 6, 2  origin = 0.2, {mid}  element = 'quad9' /
&mesh name = 'high'  size = 1.7, 1.2  cells = 7, 3  origin = 0.3, {high}  element = 'quad8' /
&material region = 'low'  young = 3.0  poisson = 0.3 /
&material region = 'mid'  young = 20.0  poisson = 0.3 /
&material region = 'high'  young = {stiff}  poisson = 0.0 /
&contact set = 'low.bottom'  friction = 0.3  point = 0.0, -0.0001 /
&contact set = 'mid.top'  against = 'high.bottom'  friction = 0.6 /
&load name = 'push'  set = 'high.top'  pressure = 3e-4 /
"""

# Two blocks as far from each other as the search, by twice a side, or overlapping by half a side.
APART = """&mesh name = 'low'  size = {low}, 1.0  cells = 8, 2  origin = {x}, {y} /
&mesh name = 'high'  size = {high}, 1.0  cells = 6, 2  origin = {left!r}, {above!r} /
&material young = 1000.0  poisson = 0.3 /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'high.left'  un = 0.0 /
&load set = 'high.top'  traction = 0.0, -1.0 /
&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /
"""

# A slave of which the master covers 95 % of a side.
END = """&mesh name = 'low'  size = {end!r}, 1.0  cells = 7, 2  origin = {x}, 0.0 /
&mesh name = 'high'  size = {whole!r}, 1.0  cells = 9, 3  origin = {x}, 1.0 /
&material young = 1000.0  poisson = 0.3 /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'high.left'  un = 0.0 /
&load set = 'high.top'  traction = 0.05, -1.0 /
&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /
"""

# A parallelogram of two blocks whose guided flanks are at 60 degrees to the normal of their contact.
ASLANT = """&mesh name = 'low'  file = 'low.msh' /
&mesh name = 'high'  file = 'high.msh' /
&material young = 1000.0  poisson = 0.3 /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'low.left'  un = 0.0 /
&support set = 'high.left'  un = 0.0 /
&load set = 'high.top'  pressure = 1.0 /
&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /
"""


class Rounding(Verification):
    """Cases that were refused because of rounding errors."""

    def summary_of(self, deck):
        """Solves and verifies a deck; its summary."""
        self.solve_into_results(deck)
        self.verify()
        return json.loads((self.results/"case_0.summary.json").read_text(encoding="utf-8"))

    def test_gaps_of_bodies_at_rest_have_the_rounding_errors_of_coordinates(self):
        # The upper body leaves the overlap without forces: its displacements are as small as the overlap.
        for overlap in (1e-12, 1e-10, 1e-9, 1e-8, 1e-6):
            for held in ("support set = 'a.bottom'  ux = 0.0  uy = 0.0", "contact set = 'a.bottom'  friction = 0.3"):
                with self.subTest(overlap=overlap, held=held):
                    self.summary_of(f"""&mesh name = 'a'  size = 2.215, 1.0  cells = 2, 2  element = 'tri6' /
&mesh name = 'b'  size = 2.758, 1.0  cells = 6, 2  origin = 0.0, {1.0 - overlap!r}  element = 'tri6' /
&material young = 1000.0  poisson = 0.3 /
&{held} /
&contact set = 'b.bottom'  against = 'a.top'  friction = 0.3 /
""")

    def test_bodies_that_nothing_loads_leave_overlaps_by_a_rigid_motion(self):
        # They had the overlaps themselves for displacements, which are rigid motions but for rounding errors: strains
        # without forces in the first step.
        for held in ("support set = 'low.bottom'  ux = 0.0  uy = 0.0", "contact set = 'low.bottom'  friction = 0.3",
                     "support set = 'low.bottom'  spring_n = 10.0  spring_t = 10.0"):
            for overlap in (1e-13, 1e-12, 1e-9, 1e-5):
                for shift in (0.5, 1.7):
                    with self.subTest(held=held, overlap=overlap, shift=shift):
                        summary = self.summary_of(OVERLAPPING.format(held=held, height=1.5 - overlap, shift=shift))
                        self.assertEqual(summary["resultants"]["normal_force"], 0.0)

    def test_loads_that_almost_cancel_have_a_sharp_limit(self):
        # The method measures by what is left of them on the contact points, the check before it by their sum.
        lifted = "&load set = 'top'  pressure = -1.0 /\n&load body_force = 0.0, {} /\n".format
        pushed = "&load body_force = {}, -1.0 /\n".format
        for element, cells in (("tri3", "5, 4"), ("quad9", "4, 3")):
            for loads in (lambda share: lifted(-0.5/share), lambda share: pushed(0.25*share)):
                for excess, status in ((-1e-11, 0), (1e-11, 2), (3e-11, 2)):
                    with self.subTest(element=element, excess=excess):
                        self.solve_into_results(
                            f"&mesh size = 4.0, 2.0  cells = {cells}  element = '{element}' /\n"
                            "&material young = 1000.0  poisson = 0.25 /\n&contact set = 'bottom'  friction = 0.25 /\n"
                            + loads(1.0 + excess), status=status)

    def test_a_load_on_the_contact_points_themselves_strains_nothing(self):
        # A body is pulled up against a ceiling by a load on the side that meets it: displacements are 1e-16.
        self.summary_of("""&mesh size = 10.790850158564059, 7.27897783948317  cells = 5, 3  element = 'tri3' /
&material young = 1268.5380677830908  poisson = 0  hypothesis = 'plane strain' /
&contact set = 'left'  friction = 0.44378546186360435  point = 0.0, 3.639488919741585  normal = 1.0, 0.0 /
&contact set = 'top'  friction = 0.1032611393966282  point = 5.395425079282029, 7.27897783948317  normal = 0.0, -1.0 /
&contact set = 'right'  friction = 0.3  point = 10.790850158564059, 3.639488919741585  normal = -1.0, 0.0 /
&load set = 'top'  pressure = -0.4782476999864511 /
""")
        self.solve_into_results("""&mesh size = 3.5089623095412783, 1.3505013250106093  cells = 6, 3  element = 'tri6' /
&material young = 139651.46367920676  poisson = 0.3  hypothesis = 'axisymmetric' /
&support set = 'left'  ux = 0.0 /
&contact set = 'bottom'  friction = 0.3  slip_bound = 50.933  multipliers = 'constant'  normal = 0.0, 1.0 /
&contact set = 'top'  friction = 0.3  point = 0.0, 1.3505013250106093  normal = 0.0, -1.0 /
&contact set = 'right'  friction = 0.1  point = 3.5089623095412783, 0.675  normal = -1.0, 0.0 /
&load set = 'top'  pressure = -178.85940358207247 /
&load set = 'top'  traction = 0.0, -66.04000839524298 /
""")

    def test_rounding_errors_of_gaps_are_small_against_what_the_load_would_press_in(self):
        # As above, with a softer block that hangs on the body: walls touch it but for the last digit.
        self.summary_of("""&mesh name = 'a'  size = 5.438889330190927, 5.276733176869928  cells = 6, 2
   element = 'quad8'  origin = 0.8301042122816042, 0.0 /
&mesh name = 'b'  size = 5.438889330190927, 5.14973502369773  cells = 3, 2  element = 'quad8'
   origin = 0.8301042122816042, 5.276733176869928 /
&material region = 'a'  young = 4233.07689220171  poisson = 0.3  hypothesis = 'plane strain' /
&material region = 'b'  young = 269758.97575519606  poisson = 0.45  hypothesis = 'plane strain' /
&tie set = 'b.bottom'  to = 'a.top' /
&contact set = 'b.right'  friction = 0.1  point = 6.268993542472531, 7.851600688718793  normal = -1.0, 0.0 /
&contact set = 'a.left'  friction = 1.2  point = 0.8301042122816042, 2.638366588434964  normal = 1.0, 0.0 /
&contact set = 'a.bottom'  friction = 1.2  normal = 0.0, 1.0 /
&contact set = 'a.right'  point = 6.268993542472531, 2.638366588434964  normal = -1.0, 0.0 /
&contact set = 'b.top'  friction = 0.6  point = 3.5495488773770676, 10.426468200567658  normal = 0.0, -1.0 /
&load set = 'b.top'  pressure = -16.416221203088742 /
""")

    def test_loads_that_cancel_leave_their_rounding_errors(self):
        # A hundred millionth of the loads presses the block on a smooth floor; along it they cancel but for rounding.
        deck = """&mesh size = 5.0, 2.0  cells = 7, 3 /
&material young = 1000.0  poisson = 0.3  expansion = 1e-5 /
&contact set = 'bottom' /
&load set = 'top'  traction = 0.1, -1.0 /
&load set = 'top'  traction = 0.2, -1.0 /
&load set = 'top'  traction = -0.3, 1.99999999 /
"""
        for heat in ("", "&load temperature = 100.0  temperature_slope = 10.0, 3.0 /\n"):
            summary = self.summary_of(deck + heat)
            self.assertAlmostEqual(summary["resultants"]["normal_force"]/5e-8, 1.0, places=6)

    def test_products_with_the_matrix_of_a_stiff_body_that_hangs_on_a_soft_one(self):
        # The condensed stiffness is that of the soft body, but the terms of the products are those of the stiff one.
        self.summary_of("""&mesh name = 'low'  size = 8.0, 2.0  cells = 16, 3  element = 'tri3' /
&mesh name = 'high'  size = 8.0, 4.0  cells = 8, 4  origin = 0.0, 2.0  element = 'quad8' /
&material region = 'low'  young = 150.0  poisson = 0.49999  hypothesis = 'axisymmetric' /
&material region = 'high'  young = 1.0  poisson = 0.0  hypothesis = 'axisymmetric' /
&support set = 'low.left'  ux = 0.0 /
&support set = 'high.left'  ux = 0.0 /
&support set = 'high.top'  uy = 1e-5 /
&tie set = 'high.bottom'  to = 'low.top' /
&contact set = 'low.bottom'  friction = 0.3 /
&solver condensation = 'band' /
""")

    def test_displacements_far_smaller_than_the_gaps_that_a_body_crosses_to_its_obstacles(self):
        # Rigid motions of the size of the gaps cancel in displacements of a billionth of it: what is left is rigid.
        summary = self.summary_of("""&mesh name = 'low'  size = 0.008, 0.008  cells = 8, 4 /
&mesh name = 'high'  size = 0.008, 0.004  cells = 7, 3  origin = 0.0, 0.008 /
&material young = 2e8  poisson = 0.3  region = 'low' /
&material young = 6e9  poisson = 0.3  region = 'high' /
&support set = 'high.top'  spring_t = 3.5e8 /
&load set = 'high.top'  pressure = 1e-11 /
&contact set = 'low.bottom'  slip_bound = 15000.0  obstacle = 'circle'  radius = 0.1  point = 0.004, 0.0 /
&contact set = 'low.top'  against = 'high.bottom'  friction = 0.1 /
""")
        # Rounding errors below the tolerance of methods, 1e-10, are not refined.
        self.assertLess(summary["certificate"]["equilibrium"], 2e-10)

    def test_obstacle_that_touches_but_for_the_last_digit(self):
        # A block on rollers, drawn turned: without loads, the overlap of rounding with the wall beside it pushed it.
        for turn in (0.1, 0.2, 0.4, 0.6, 0.7):
            along, across = (cos(turn), sin(turn)), (-sin(turn), cos(turn))
            place = [3.0*along[k] + across[k] + 7.0*(k == 0) for k in range(2)]
            self.write("turned.msh", mapped_mesh((4, 3), "quad4", lambda s, t: tuple(  # noqa: B023
                3.0*s*along[k] + 2.0*t*across[k] + 7.0*(k == 0) for k in range(2))))
            self.summary_of(f"""&mesh file = 'turned.msh' /
&material young = 1000.0  poisson = 0.3 /
&support set = 'bottom'  un = 0.0 /
&contact set = 'right'  friction = 0.3  point = {place[0]!r}, {place[1]!r}  normal = {-along[0]!r}, {-along[1]!r} /
""")

    def test_loose_block_in_a_body_of_held_parts_whose_ties_lie_apart(self):
        # Tied parts that cannot turn strain no tie; the overlap lifts the block that lies on them, by a rigid motion.
        self.write("low.msh", mapped_mesh((6, 2), "quad4", lambda s, t: (4.0*s, t*(1.0 + 0.08*s*(1.0 - s)))))
        self.write("coat.msh", mapped_mesh((9, 1), "quad4", lambda s, t: (4.0*s, 1.0 + 0.1*t)))
        self.write("high.msh", mapped_mesh((5, 2), "quad4", lambda s, t: (0.5 + 3.0*s, 1.1 + t)))
        summary = self.summary_of("""&mesh name = 'low'  file = 'low.msh' /
&mesh name = 'coat'  file = 'coat.msh' /
&mesh name = 'high'  file = 'high.msh' /
&material region = 'coat.body'  young = 5.0  poisson = 0.3 /
&material young = 6000.0  poisson = 0.3 /
&tie set = 'low.top'  to = 'coat.bottom' /
&support set = 'low.bottom'  un = 0.0  ut = 0.0 /
&contact set = 'coat.top'  against = 'high.bottom'  friction = 0.1  extra_gap = -3e-4 /
""")
        self.assertAlmostEqual(summary["key_results"]["max_displacement"], 3e-4, delta=1e-15)

    def test_side_that_is_straight_but_for_the_last_digit_agrees_with_a_rigid_motion_along_it(self):
        # The normal of the upper end has a component of 1e-15 along the motion.
        self.write("side.msh", mapped_mesh((3, 2), "quad4", lambda s, t: (3.0*s + 1e-15*s*(t > 0.9), 2.0*t)))
        self.summary_of("""&mesh file = 'side.msh' /
&material young = 1000.0  poisson = 0.3 /
&rigid name = 'punch'  set = 'top'  ux = 0.0  uy = -1e-3  turn = 0.0 /
&support set = 'right'  un = 0.0 /
&contact set = 'bottom'  friction = 0.3 /
""")

    def test_one_more_step_of_newton_where_nothing_presses(self):
        # A shim moves a block that touches nothing: a residual just within the tolerance would be all its forces.
        for low, high in (("tri3", "quad8"), ("quad8", "quad8"), ("quad8", "tri3")):
            summary = self.summary_of(f"""&mesh name = 'low'  size = 8.46, 2.62  cells = 7, 2  element = '{low}' /
&mesh name = 'high'  size = 8.46, 2.5  cells = 2, 3  element = '{high}'  origin = 0.0, 2.62 /
&material region = 'low'  young = 16.85  poisson = 0.3 /
&material region = 'high'  young = 446.3  poisson = 0.499 /
&preload name = 'shim'  set = 'high.bottom'  to = 'low.top'  shortening = 3.7e-4 /
&support set = 'high.top'  un = 0.0 /
&contact set = 'low.bottom'  friction = 0.86  extra_gap = 1.73e-4  gap_slope = -5e-6, 0.0 /
&contact set = 'high.right'  friction = 0.3  point = 8.46, 2.6  normal = -1.0, 0.0 /
""")
            self.assertLess(summary["certificate"]["equilibrium"], 1e-10)

    def test_apex_between_the_nodes_of_a_curved_body_that_does_not_move(self):
        # The chord of the side over the apex lies in the obstacle; nothing moves to compare that with.
        self.write("arched.msh", mapped_mesh((5, 2), "quad4", lambda s, t: (
            2.0*s, t - 0.05*(1.0 - t)*(2.0*s - 1.0)**2)))
        self.summary_of("""&mesh file = 'arched.msh' /
&material young = 1000.0  poisson = 0.3 /
&load set = 'top'  pressure = 1.0 /
&support set = 'top'  un = 0.0  ut = 0.0 /
&contact set = 'bottom'  friction = 0.3  obstacle = 'parabola'  radius = 10.0  point = 1.0, 0.0 /
""")

    def test_nothing_but_loads_drives_a_loose_block_that_a_preload_moves(self):
        # A shim lifts the coat with the block that lies on it: rounding drove the block, which had no equilibrium.
        for rise, n_low, n_coat, n_high, modulus, stiffness in (
                (0.02, 8, 6, 6, 2e4, 1300.0), (0.02, 7, 7, 2, 2e4, 50.0), (0.05, 5, 7, 6, 1e6, 50.0)):
            self.write("low.msh", mapped_mesh((n_low, 2), "tri3", lambda s, t: (  # noqa: B023
                4.0*s, t*(1.0 + 4.0*rise*s*(1.0 - s)))))
            self.write("coat.msh", mapped_mesh((n_coat, 1), "quad4", lambda s, t: (4.0*s, 1.0 + 0.1*t)))
            self.write("high.msh", mapped_mesh((n_high, 2), "quad4", lambda s, t: (0.5 + 3.0*s, 1.1 + t)))
            self.summary_of(f"""&mesh name = 'low'  file = 'low.msh' /
&mesh name = 'coat'  file = 'coat.msh' /
&mesh name = 'high'  file = 'high.msh' /
&material region = 'low.body'  young = {modulus}  poisson = 0.49 /
&material region = 'coat.body'  young = 0.5  poisson = 0.3 /
&material region = 'high.body'  young = 1300.0  poisson = 0.3 /
&preload name = 'shim'  set = 'coat.bottom'  to = 'low.top'  shortening = 3e-5 /
&support set = 'low.bottom'  spring_n = {stiffness}  spring_t = 5800.0 /
&contact set = 'coat.top'  against = 'high.bottom'  friction = 0.5 /
""")

    def test_rounding_errors_of_forces_do_no_work(self):
        # A load on the side that a wall bears: the rest of the body is free of forces but for rounding.
        deck = """&mesh size = 6.09167894061312, 6.313455047944747  cells = 3, 3  origin = -19.59692976188971, 0.0 /
&material young = 1883.0935900197949  poisson = 0.45  hypothesis = 'plane strain' /
&contact set = 'right'  friction = 0.1  point = -13.505250821276592, 3.1567275239723736  normal = -1.0, 0.0 /
&contact set = 'left'  friction = 0.3  point = -19.59692976188971, 3.1567275239723736  normal = 1.0, 0.0 /
&load set = 'left'  traction = -0.6834169764053899, 0.0 /
"""
        self.summary_of(deck)
        self.summary_of(deck + "&history times = 1.0 /")
        # A torque on the side that slip bounds hold: all points are at rest.
        self.summary_of("""&mesh name = 'a'  size = 3.7044931809484467, 2.449450655932392  cells = 4, 4 /
&mesh name = 'b'  size = 3.7044931809484467, 1.878608688269873  cells = 4, 2  origin = 0.0, 2.449450655932392 /
&material young = 6762.678955122956  poisson = 0.45  hypothesis = 'axisymmetric'  twist = .true. /
&support set = 'a.left'  ux = 0.0 /
&support set = 'b.left'  ux = 0.0 /
&contact set = 'a.bottom'  friction = 1.0 /
&contact set = 'b.bottom'  against = 'a.top'  friction = 0.3  slip_bound = 0.001401447244887221 /
&contact set = 'b.right'  slip_bound = 0.09530137774414543  normal = -1.0, 0.0  point = 3.7044931809484467, 0.0 /
&load set = 'b.right'  torque = 8.47386002693587 /
&history times = 1.0 /
""")

    def test_free_expansion_leaves_rounding_errors_of_the_forces_that_would_prevent_it(self):
        # The cooled disk shrinks away from its wall; the pressure acts on the support that bears it.
        for pressure in (0.0, 0.01, 1.0, 15.0):
            summary = self.summary_of(
                "&mesh size = 4.0, 1.0  cells = 32, 8  element = 'quad9' /\n"
                "&material young = 200000.0  poisson = 0.3  expansion = 1e-5  hypothesis = 'axisymmetric' /\n"
                "&support set = 'bottom'  un = 0.0 /\n&support set = 'left'  un = 0.0 /\n&load temperature = -40.0 /\n"
                f"&load set = 'bottom'  pressure = {pressure} /\n"
                "&contact set = 'right'  friction = 0.3  normal = -1.0, 0.0  point = 100.0, 0.0 /\n")
            self.assertEqual(summary["outcome"], "solved", pressure)

    def test_a_large_radius_has_an_angle_from_one_node_to_the_next(self):
        # The normals at two nodes differ by 1e-11, whose cosine is 1 to rounding. The apex between two nodes is 2e-12
        # higher than these; the body yields by 5e-12.
        self.summary_of("""&mesh size = 10.0, 1.0  cells = 5, 2 /
&material young = 2.0e11  poisson = 0.0 /
&load set = 'top'  pressure = 1.0 /
&support set = 'left'  ux = 0.0 /
&contact set = 'bottom'  friction = 0.3  obstacle = 'parabola'  radius = 3.0e11  point = 5.0, 0.0 /
""")

    def test_a_stiff_body_that_a_support_moves_presses_a_soft_one(self):
        # Its displacement is 1e7 times its strains: with the rounding errors of one solution resultants missed 2.5e-8
        # at 1e6 already. The force comes near that of rigid blocks as the modulus grows.
        force = [self.summary_of(PRESSED.format(stiff=stiff))["key_results"]["force_normal_soft.top"]
                 for stiff in (1e5, 1e6, 1e7)]
        self.assertAlmostEqual((force[0] - force[2])/(force[1] - force[2]), 11.0, delta=0.1)

    def test_a_stiff_body_that_only_soft_ones_hold(self):
        # The condensed stiffness has rounding errors as large as the forces. These come near those of a rigid block:
        # the differences are 3e-8 and 3e-9 of the peaks, which are known to about 1e-10.
        joints = ("contact set = 'mid.bottom'  against = 'low.top'  friction = 0.1",
                  "tie set = 'mid.bottom'  to = 'low.top'")
        for joint in joints:
            for gap in (0.0, 7e-4, 0.05):
                peaks = [
                    self.summary_of(LOOSE.format(stiff=stiff, mid=1.1 + gap, high=3.1 + 1.5*gap) + f"&{joint} /\n")
                    ["key_results"]["max_contact_pressure"] for stiff in (2e5, 2e6, 2e7)]
                with self.subTest(joint=joint, gap=gap):
                    self.assertAlmostEqual((peaks[0] - peaks[2])/(peaks[1] - peaks[2]), 11.0, delta=1.0)

    def test_rows_and_steps_of_a_stiff_body_that_only_soft_ones_hold(self):
        deck = LOOSE.format(stiff=2e7, mid=1.1, high=3.1) + "&tie set = 'mid.bottom'  to = 'low.top' /\n"
        peak = self.summary_of(deck)["key_results"]["max_contact_pressure"]
        step = self.summary_of(deck + "&history times = 0.0, 1.0 /\n&steps load = 'push'  factor = 0.1, 1.0 /\n")
        self.assertAlmostEqual(step["key_results"]["max_contact_pressure"]/peak, 1.0, places=7)
        self.solve_into_results(deck + "&sweep load = 'push'  factor = 0.5, 1.0 /\n")
        self.verify()

    def test_energies_of_a_long_body_that_is_tied_to_a_nearly_incompressible_one(self):
        # No contact: the works of the parts of the load are those of their own displacements.
        for stiff in (12.0, 1e4):
            self.summary_of(f"""&mesh name = 'low'  size = 3.0, 1.0  cells = 15, 4  element = 'quad8' /
&mesh name = 'high'  size = 19.0, 1.2  cells = 3, 6  origin = -0.5, 1.0  element = 'tri6' /
&material young = 12.0  poisson = 0.499  region = 'low' /
&material young = {stiff}  poisson = 0.499  region = 'high' /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&tie set = 'high.bottom'  to = 'low.top' /
&load name = 'push'  set = 'high.top'  traction = 2e-5, -1e-3 /
&history times = 0.0, 1.0, 2.0  substeps = 2 /
&steps load = 'push'  factor = 0.2, 1.0, 0.1 /
""")

    def test_a_body_that_is_released_is_at_rest(self):
        results = self.summary_of(STACK)["key_results"]
        self.assertEqual((results["max_contact_pressure"], results["max_displacement"]), (0.0, 0.0))

    def test_a_body_that_no_load_drives_stays_where_it_is_drawn(self):
        # A ring squeezed from outside, between floor and ceiling: gaps of 0.1, strains of 1e-4.
        for shift in (0.0, 3.7):
            results = self.summary_of(f"&mesh size = 1.0, 1.7  cells = 3, 2  origin = 0.3, {shift} /\n"
                                      "&material young = 900.0  poisson = 0.3  hypothesis = 'axisymmetric' /\n"
                                      "&load set = 'right'  pressure = 0.12 /\n"
                                      "&contact set = 'bottom'  friction = 0.3  obstacle = 'circle'  radius = 5.0"
                                      f"  point = 0.25, {shift - 0.2}  normal = -0.2, 0.97 /\n"
                                      "&contact set = 'top'  friction = 0.5  obstacle = 'circle'  radius = 1.1"
                                      f"  point = 0.71, {shift + 1.8}  normal = 0.0, -1.0 /\n")["key_results"]
            self.assertLess(results["max_displacement"], 2e-4)

    def test_displacements_of_steps_are_counted_from_the_rigid_motion(self):
        # What the way to the floor leaves of a stiffness times itself is no force.
        results = self.summary_of(FALLEN)["key_results"]
        self.assertAlmostEqual(results["contact_force_y"], 7.6e-9*(5.6*1.19 + 3.5*1.5), delta=1e-18)

    def test_energies_of_a_body_that_moves_back_are_measured_by_its_way(self):
        self.summary_of("&mesh size = 4.0, 2.0  cells = 8, 4 /\n"
                        "&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric' /\n"
                        "&support name = 'lid'  set = 'top'  uy = -0.001 /\n"
                        "&contact set = 'bottom'  friction = 0.3  extra_gap = 0.01 /\n"
                        "&history times = 0.0, 1.0, 2.0  substeps = 2 /\n"
                        "&steps support = 'lid'  factor = 0.0, 1.0, 0.0 /\n")

    def test_what_a_rigid_motion_does_not_move_is_no_part_of_it(self):
        # A wall leaves the vertical motion free, to which the strains, of 1e-14, are no rounding along the floor.
        results = self.summary_of("&mesh size = 5.0, 2.0  cells = 22, 2  element = 'quad9' /\n"
                                  "&material young = 300.0  poisson = 0.2 /\n"
                                  "&load set = 'top'  total_force = 0.0, -5e-12 /\n"
                                  "&support set = 'right'  ux = 0.0 /\n"
                                  "&contact set = 'bottom'  friction = 0.1  extra_gap = -3e-6 /\n")["key_results"]
        # Displacements of 3e-6 are known to 4e-22, times the stiffness that is 1e-19 at each node.
        self.assertAlmostEqual(results["reaction_x_right"], -results["contact_force_x"], delta=1e-18)

    def test_gaps_of_rounding_size_are_no_penetration(self):
        # Coordinates are known to 1e-16, the displacements are 1e-11.
        for young in (2e9, 2e11, 2e13):
            with self.subTest(young=young):
                self.summary_of("&mesh name = 'a'  size = 5.142875662356811, 0.7354020165073905  cells = 5, 2"
                                "  element = 'quad9' /\n"
                                "&mesh name = 'b'  size = 3.438500417869192, 1.3576553464617827  cells = 19, 2"
                                "  origin = 1.289983626436224, 0.7354020165073905 /\n"
                                f"&material young = {young}  poisson = 0.3 /\n"
                                "&support set = 'a.bottom'  ux = 0.0  uy = 0.0 /\n"
                                "&load set = 'b.top'  pressure = 1.0  traction = 0.1, 0.0 /\n"
                                "&contact set = 'b.bottom'  against = 'a.top'  friction = 0.5 /\n")

    def test_slender_strip_that_bends_far(self):
        # The middle lies on the circle, the ends bend down by 2.5: to 4e-16, times a stiffness of 1e4 per length,
        # beside forces of 5e-4 at each node.
        summary = self.summary_of("&mesh size = 200.0, 1.0  cells = 200, 2 /\n"
                                  "&material young = 1000.0  poisson = 0.3 /\n&support set = 'left'  ux = 0.0 /\n"
                                  "&load set = 'top'  pressure = 5e-4 /\n&contact set = 'bottom'  friction = 0.3  "
                                  "obstacle = 'circle'  radius = 2000.0  point = 100.0, 0.0 /\n")
        self.assertAlmostEqual(summary["key_results"]["contact_force_y"], 0.1, delta=1e-7)

    def test_slender_strip_lifted_at_its_end(self):
        # It bends by up to 60 times its length: products of its stiffness with such displacements have no digit left.
        for length in (160.0, 300.0):
            weight, force = 0.05*length, 0.022*length
            results = self.summary_of(f"""&mesh size = {length}, 1.0  cells = 54, 2  element = 'quad9' /
&material young = 200000.0  poisson = 0.3 /
&contact set = 'bottom'  friction = 0.1 /
&load body_force = 0.0, -0.05 /
&load point = {length}, 1.0  force = 0.0, {force!r} /
""")["key_results"]
            # The floor bears what is left, at the place that balances the moments: to the limit of the certificate.
            rest = weight - force
            self.assertAlmostEqual(results["contact_force_y"]/rest, 1.0, delta=1e-8)
            self.assertAlmostEqual(results["contact_centroid_x"]/length, (0.5*weight - force)/rest, delta=1e-8)

    def test_factor_that_passes_zero_at_the_end_of_a_step(self):
        # A third of the way from -0.157 to 0.314 the load is 0, no rounding error; supports move the body by far more.
        self.summary_of("""&mesh size = 3.0, 1.0  cells = 5, 3  origin = 2.0, 0.0 /
&material young = 7000.0  poisson = 0.0  hypothesis = 'axisymmetric' /
&load name = 'push'  set = 'right'  traction = 0.7, 0.0 /
&support name = 'top'  set = 'top'  uy = -0.001 /
&contact set = 'bottom'  point = 0.0, -0.002 /
&history times = 0.0, 1.0, 2.0  substeps = 3 /
&steps load = 'push'  factor = 0.0, -0.157, 0.314 /
&steps support = 'top'  factor = 0.0, 1.0, 0.0 /
&output fields_every = 1 /
""")

    def test_body_that_was_wedged_springs_back_to_where_it_is_drawn(self):
        # Far from the origin, on a floor that it touches at one corner, and beside a wall.
        for angle in (2.0, 4.0):
            def turned(x, y, angle=angle):
                return cos(angle)*x - sin(angle)*y, sin(angle)*x + cos(angle)*y

            def place(x, y, turned=turned):
                return tuple(map(sum, zip((-5.0, 31.0), turned(x, y))))

            self.write("turned.msh", mapped_mesh((3, 14), "quad4", lambda s, t, place=place:
                                                 place(6.44*t, 1.71*(1.0 - s)), n_pressed=2))
            summary = self.summary_of("""&mesh file = 'turned.msh' /
&material young = 2500.0  poisson = 0.3  hypothesis = 'plane stress' /
&support set = 'pressed'  un = 0.0 /
&load name = 'press'  set = 'left'  pressure = 1.1 /
&contact set = 'right'  point = {!r}, {!r}  normal = {!r}, {!r} /
&contact set = 'bottom'  friction = 0.2  point = {!r}, {!r}  normal = {!r}, {!r} /
&history times = 0.0, 1.0, 2.0 /
&steps load = 'press'  factor = 1.0, 1.5, 0.0 /
""".format(*place(6.44, 0.0), *turned(-0.03, 1.0), *place(-2e-4, 0.0), *turned(1.0, 0.0)))
            self.assertLess(summary["key_results"]["max_displacement"], 1e-12)

    def test_guides_along_the_way_of_an_unloaded_body_do_not_hold_it(self):
        # It leaves an overlap of 0.006 along its guides; the slip bound holds it across, times rounding errors along.
        for angle in (1.5, 5.0):
            def turned(x, y, angle=angle):
                return cos(angle)*x - sin(angle)*y, sin(angle)*x + cos(angle)*y

            def place(s, t, turned=turned):
                return tuple(map(sum, zip((-30.0, 40.0), turned(6.0*s, 2.0*t))))

            self.write("guided.msh", mapped_mesh((4, 3), "quad4", place))
            summary = self.summary_of("&mesh file = 'guided.msh' /\n&material young = 2500.0  poisson = 0.3 /\n"
                                      "&support set = 'right'  un = 0.0 /\n&contact set = 'bottom'  friction = 0.1  "
                                      "slip_bound = 0.2  point = {!r}, {!r}  normal = {!r}, {!r} /\n".format(
                                          *place(1.0, 0.003), *turned(-0.03, 1.0)))
            self.assertAlmostEqual(summary["key_results"]["max_displacement"], 0.006, delta=1e-11)

    def test_cells_of_a_body_on_soft_springs(self):
        # The springs are 1e-10 as stiff as the body.
        summary = self.summary_of("&mesh size = 3000.0, 600.0  cells = 18, 6 /\n"
                                  "&material young = 5000.0  poisson = 0.0 /\n"
                                  "&support set = 'top'  spring_n = 2e-7  spring_t = 1e-7 /\n"
                                  "&load set = 'top'  pressure = 0.1 /\n"
                                  "&contact set = 'bottom'  friction = 0.3  multipliers = 'constant' /\n")
        # All but what the springs bear, 2e-7 (0.1/5000 600) 3000.
        self.assertAlmostEqual(summary["key_results"]["contact_force_y"], 300.0 - 7.2e-6, delta=1e-7)

    def test_limits_of_meshes_are_no_round_numbers(self):
        # A place of the bodies changes the last digit of what is compared with the limit. The search includes its end.
        for side in (0.5, 0.3, 0.1, 0.7):
            for deck, height in ((APART, 2*side), (APART, -0.5*side), (END, 0.0)):
                found = set()
                for x, y in ((0.0, 0.0), (3.1, 0.7), (0.3, 0.1), (-7.9, 3.3)):
                    self.solve_into_results(deck.format(
                        low=8*side, high=6*side, x=x, y=y, left=x + side, above=y + 1.0 + height,
                        end=round(6.95*side, 9), whole=9*side))
                    summary = json.loads((self.results/"case_0.summary.json").read_text(encoding="utf-8"))
                    found.add(f'{summary["key_results"]["max_contact_pressure"]:.6g}')
                with self.subTest(side=side, height=height):
                    self.assertEqual(len(found), 1, found)

    def test_a_guide_at_60_degrees_to_the_normal_holds_a_plane_of_symmetry(self):
        forces = []
        for turn in (0.0, 0.3, 1.6, 1.7000000000000002, 1.85):
            for name, columns, height in (("low", 8, -1.0), ("high", 7, 0.0)):
                def place(s, t, height=height, turn=turn):
                    x, y = 4.0*s + (t + height)*tan(pi/6), t + height
                    return x*cos(turn) - y*sin(turn), x*sin(turn) + y*cos(turn)
                self.write(f"{name}.msh", mapped_mesh((columns, 2), "quad4", place))
            self.solve_into_results(ASLANT)
            forces.append(json.loads((self.results/"case_0.summary.json").read_text(encoding="utf-8"))
                          ["resultants"]["normal_force"])
        self.assertLess(max(forces)/min(forces) - 1.0, 1e-8, forces)

    def test_a_node_opposite_to_the_end_of_a_master_is_beside_a_segment(self):
        # The end is opposite to the middle node of a side: by its last digit the node was beyond it, and penetrated.
        for unit, x in ((1.0, 0.0), (0.3, 3.1), (0.3, 1.7), (0.7, 3.1)):
            with self.subTest(unit=unit, x=x):
                self.summary_of(f"""&mesh name = 'a'  size = {3*unit!r}, {unit!r}  cells = 3, 2
   origin = {(x + 0.5)*unit!r}, 0.0  element = 'quad8' /
&mesh name = 'b'  size = {2*unit!r}, {2*unit!r}  cells = 2, 4  origin = {x*unit!r}, {1.01*unit!r}  element = 'tri6' /
&material region = 'a'  young = 100.0  poisson = 0.0 /
&material region = 'b'  young = 100000.0  poisson = 0.25 /
&contact set = 'a.bottom'  friction = 0.5 /
&support set = 'b.left'  ux = 0.0 /
&contact set = 'b.bottom'  against = 'a.top'  friction = 0.5 /
&load set = 'b.top'  pressure = 2.0 /
&load set = 'b.left'  traction = -0.5, 0.0 /
""")

    def test_nodes_that_miss_the_axis_by_the_last_digit_lie_on_it(self):
        # The normal of a cone's tip lies along the axis.
        for slope in (0.3, -0.3):
            forces = []
            for miss in (0.0, 1e-17, 1e-13, 1e-10):
                for name, columns, low, width in (("low", 6, -1.0, 2.0), ("high", 5, 0.0, 1.0)):
                    def place(s, t, low=low, width=width, miss=miss, slope=slope):
                        return max(miss, width*s), t + low + slope*width*s
                    self.write(f"{name}.msh", mapped_mesh((columns, 4), "quad4", place))
                self.solve_into_results("""&mesh name = 'low'  file = 'low.msh' /
&mesh name = 'high'  file = 'high.msh' /
&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric' /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&load set = 'high.top'  pressure = 1.0 /
&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /
""")
                forces.append(json.loads((self.results/"case_0.summary.json").read_text(encoding="utf-8"))
                              ["resultants"]["normal_force"])
            self.assertLess(max(forces)/min(forces) - 1.0, 1e-8, forces)

    def test_elements_whose_jacobian_vanishes_at_a_corner_are_refused_wherever_they_lie(self):
        # Three corners of a quadrilateral on a line; a node in the middle of a side at a quarter of it.
        def on_a_line(s, t):
            return (0.3, 1.4) if (s, t) == (0.25, 0.5) else (4.0*s, 4.0*t)

        def at_a_quarter(s, t):
            return (0.25 if s == 0.125 else 4.0*s), 4.0*t
        for element, mapping in (("quad4", on_a_line), ("quad8", at_a_quarter), ("quad9", at_a_quarter)):
            for move in (0.0, 0.7, 3.1, 1e3):
                for unit in (1.0, 0.3, 25.4, 1e-3):
                    def place(s, t, move=move, unit=unit, mapping=mapping):
                        x, y = mapping(s, t)
                        return (x + move)*unit, (y + 0.3*move)*unit
                    self.write("body.msh", mapped_mesh((4, 2), element, place))
                    self.solve_into_results("""&mesh file = 'body.msh' /
&material young = 1000.0  poisson = 0.3 /
&support set = 'top'  ux = 0.0  uy = 0.0 /
&load set = 'right'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.3 /
""", status=1)

    def test_warnings_begin_above_their_limits(self):
        # Displacements of 5 %, an overlap of 1 %, gaps at 30 degrees off the obstacle's normal.
        for unit in (1.0, 0.001, 0.3, 25.4, 7.7):
            for groups in (f"&support set = 'top'  ux = {0.2*unit!r}  uy = 0.0 /\n"
                           f"&contact set = 'bottom'  point = 0.0, {-0.01*unit!r} /\n",
                           "&load set = 'top'  pressure = 1e-6 /\n"
                           f"&contact set = 'bottom'  point = 0.0, {0.04*unit!r}  friction = 0.3 /\n",
                           "&load set = 'top'  pressure = 1e-6 /\n&support set = 'left'  ux = 0.0  uy = 0.0 /\n"
                           f"&contact set = 'bottom'  friction = 0.3  gap_direction = {0.5*unit!r}, "
                           f"{-(0.75**0.5)*unit!r} /\n"):
                with self.subTest(unit=unit, groups=groups):
                    warnings = self.summary_of(f"&mesh size = {4.0*unit!r}, {unit!r}  cells = 8, 2 /\n"
                                               "&material young = 1000.0  poisson = 0.3 /\n" + groups)["warnings"]
                    self.assertNotRegex(" ".join(warnings), "small displacements|initial overlap|30 degrees")


if __name__ == "__main__":
    unittest.main()
