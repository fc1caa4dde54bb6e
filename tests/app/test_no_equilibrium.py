#!/usr/bin/env python3
"""Cases without equilibrium: an answer, with files that say so."""
import json
import math
import unittest

from harness import CONTACT, PRESSURE, SOUND, SUPPORT, ProgramTest, block
from mapped_mesh import mapped_mesh
from rings import hung_ring, ring, ring_on_elastic_pin

NO_EQUILIBRIUM = "no equilibrium: contact and friction cannot balance the loads; the body is free to "
ADVICE = "; add a support, or a load that presses the body on its obstacle\n"
BUT_FOR_THE_MESH = ("no equilibrium but for the irregularities of the mesh: contact and friction on the round line "
                    "that its nodes lie on cannot balance the loads; the body is free to {}; add a support or "
                    "friction\n")
EXHAUSTED = ("no equilibrium but for the irregularities of the mesh: all contact points slip or open, and friction on "
             "the round line that its nodes lie on cannot balance the loads; the body is free to {}; add a support or "
             "friction\n")
SPINNING = ("no equilibrium: all contact points slip or open, and friction cannot balance the loads; the body is free "
            "to {}; add a support or friction\n")
LIFTED = block(SUPPORT, CONTACT, "load set = 'top'  traction = 0.0, 1.0")


def arched_block(rise):
    """A mesh file of a block 8 x 8 whose bottom, of four sides, rises by `rise` to the middle, along a parabola."""
    return mapped_mesh((4, 4), "quad4", lambda s, t: (8.0*s, 8.0*t + 4.0*rise*(1.0 - t)*s*(1.0 - s)))


class NoEquilibrium(ProgramTest):
    """Status 2: contact and friction cannot balance the loads; the files say so."""

    def assert_no_equilibrium(self, text, message, is_seen_before=True):
        self.write("free.nml", text)
        run = self.run_program("--output", "results", "free.nml", status=2)
        self.assertEqual(run.stdout, "")
        self.assertEqual(run.stderr, f"free.nml: {message}")
        self.assertEqual(sorted(self.contents("results")), ["free.deck.nml", "free.lst", "free.summary.json"])
        summary = json.loads(self.contents("results")["free.summary.json"])
        self.assertEqual((summary["outcome"], summary["converged"]), ("no_equilibrium", False))
        self.assertEqual(summary["message"], message.rstrip("\n"))
        listing = self.contents("results")["free.lst"].decode()
        self.assertTrue(listing.endswith(f"\nSolution\n--------\n  {message}"), listing)
        self.assertEqual(self.run_program("--verify", "results").stdout, "free: verified\n")
        self.run_program("--check", "free.nml", status=2 if is_seen_before else 0)

    def test_body_that_nothing_holds(self):
        # Of a case, a sweep and a history the same listing.
        listings = set()
        for study in ("", "&sweep load = 'push'  factor = 1.0, 2.0 /\n",
                      "&history times = 0.0, 1.0 /\n&steps load = 'push'  factor = 0.0, 1.0 /\n"):
            self.assert_no_equilibrium(block(SUPPORT, "load name = 'push'  set = 'right'  traction = 1.0, 0.0") + study,
                                       "the body is free to translate along (0.0, -1.0): nothing holds it; "
                                       "add a support or a contact set\n")
            listings.add(self.contents("results")["free.lst"])
        self.assertEqual(len(listings), 1)

    def test_body_lifted_from_the_floor(self):
        self.assert_no_equilibrium(LIFTED, NO_EQUILIBRIUM + "translate along (0.0, 1.0)" + ADVICE)

    def test_body_pushed_along_the_floor(self):
        # 2 x 2 = 4 against friction of 0.3 x 4; sliding off leads up the edge of the friction cone.
        self.assert_no_equilibrium(block(PRESSURE, CONTACT, "load set = 'left'  traction = 2.0, 0.0"),
                                   NO_EQUILIBRIUM + "translate along (1.0, 0.3)" + ADVICE)

    def test_limit_of_sliding_is_told_to_ten_digits(self):
        # Above it by 1e-9 no method ends, at it and below it some do; a light push, so that the excess is a small
        # share of all loads.
        for friction in (0.1, 0.75):
            for excess, status in ((-1e-8, 0), (-1e-10, 0), (0.0, 0), (1e-9, 2), (1e-8, 2)):
                self.write("limit.nml", block(
                    "load set = 'top'  pressure = 1.0", f"contact set = 'bottom'  friction = {friction}",
                    f"load set = 'left'  traction = {2.0*friction*(1.0 + excess)!r}, 0.0"))
                self.run_program("--quiet", "--output", "results", "limit.nml", status=status)

    def test_a_line_is_not_round_because_the_bodies_do_not_touch_at_rest(self):
        # A block on a soft and a stiff one, over a gap; a point of the soft one still sticks, just below its bound.
        deck = ("&mesh name = 'a'  size = 0.5, 1.0  cells = 5, 4 /\n"
                "&mesh name = 'b'  size = 0.6, 1.0  cells = 4, 4  origin = 0.5, -0.0005 /\n"
                "&mesh name = 'high'  size = 1.1, 0.4  cells = 9, 3  origin = 0.0, 1.0 /\n"
                "&material young = 100.0  poisson = 0.3  region = 'a' /\n"
                "&material young = 2500.0  poisson = 0.3 /\n"
                "&support set = 'a.bottom'  ux = 0.0  uy = 0.0 /\n"
                "&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /\n"
                "&load set = 'high.top'  traction = {}, -1.0 /\n"
                "&contact set = 'a.top'  against = 'high.bottom'  friction = 0.6 /\n"
                "&contact set = 'b.top'  against = 'high.bottom'  friction = 0.3 /\n")
        for push, status in (0.32, 0), (0.36, 2):
            self.write("stack.nml", deck.format(push))
            self.run_program("--quiet", "--output", "results", "stack.nml", status=status)

    def test_body_rolled_over_its_corner(self):
        # 4 upwards at x = 4 and 4 downwards at x = 2 turn the block about its left side, free along x.
        # In the middle of the block, at x = 2, a rotation by 1/sqrt(5) is a displacement of 2/sqrt(5) = 0.8944.
        self.assert_no_equilibrium(block(PRESSURE, "contact set = 'bottom'", "load set = 'right'  traction = 0.0, 2.0",
                                         "support set = 'left'  uy = 0.0"),
                                   NO_EQUILIBRIUM + "translate along (0.0, 0.8944) and rotate counter-clockwise"
                                   + ADVICE)

    def test_ring_on_a_pin_turns_under_its_load(self):
        # Forces on a smooth pin all pass its center, 0, 0: they bear a load that does so, too, and no other one.
        # Friction bears what passes within sin(arctan(0.6)) = 0.51 of the center.
        for wave, angle, friction, message in (
                (0.0, 0, 0.0, NO_EQUILIBRIUM + "rotate clockwise" + ADVICE),
                (0.01, 0, 0.0, BUT_FOR_THE_MESH.format("rotate clockwise")),
                (0.02, 24, 0.0, BUT_FOR_THE_MESH.format("rotate counter-clockwise")),
                (0.0, 36, 0.0, None), (0.01, 36, 0.0, None), (0.01, 37, 0.6, None)):
            self.write("ring.msh", ring(wave))
            turned = 2*math.pi*angle/48 + wave*math.sin(5*angle)
            force = (1e-2*math.cos(turned), 1e-2*math.sin(turned)) if angle == 36 else (0.0, -1e-2)
            deck = hung_ring(wave, angle, friction, force)
            if message:
                self.assert_no_equilibrium(deck, message)
            else:
                self.run_program("--output", "results", self.write("free.nml", deck))

    def test_twelve_sides_are_a_circle(self):
        # The line bends by 30 degrees on the average. Where it bends by more, facets would bear the moment.
        self.write("ring.msh", ring(0.02, sides=12))
        self.assert_no_equilibrium(hung_ring(0.02, 0, 0.0, (0.0, -1e-2)), BUT_FOR_THE_MESH.format("rotate clockwise"))

    def test_ring_on_a_rough_pin_turns_under_its_load(self):
        # Contact on one side of the pin bears what passes within sin(arctan(friction)) of the center, times what the
        # pressures add up to over their resultant, at most 4/pi; the load passes at 2 and at 2 sin(2 pi/48) = 0.26.
        for wave, angle, friction, message in (
                (0.0, 0, 0.2, SPINNING.format("rotate clockwise")), (0.0, 24, 0.2, SPINNING.format(
                    "rotate counter-clockwise")), (0.0, 35, 0.1, SPINNING.format("rotate counter-clockwise")),
                (0.01, 24, 0.2, EXHAUSTED.format("rotate counter-clockwise")),
                (0.0, 35, 0.4, None), (0.01, 35, 0.4, None)):
            for clearance in (0.0, 0.001):
                self.write("ring.msh", ring(wave))
                deck = hung_ring(wave, angle, friction, (0.0, -1e-2), clearance)
                if message:
                    self.assert_no_equilibrium(deck, message, is_seen_before=False)
                else:
                    self.run_program("--output", "results", self.write("free.nml", deck))

    def test_ring_on_an_elastic_pin_turns_under_its_load(self):
        # As on a rigid one; the normals are those of the slave, whichever that is. Facets of an irregular master wedge
        # the ring once it has turned by radians, so that friction would bear any moment.
        for wave, slave, angle, friction in ((0.0, "ring", 0, 0.2), (0.0, "pin", 0, 0.2), (0.01, "ring", 0, 0.0),
                                             (0.01, "pin", 0, 0.0), (0.01, "ring", 0, 0.2), (0.01, "pin", 0, 0.2),
                                             (0.02, "pin", 0, 0.2), (0.0, "ring", 35, 0.4), (0.0, "pin", 35, 0.4)):
            clearance = 0.001
            self.write("ring.msh", ring(wave))
            self.write("pin.msh", ring(0.0, [(1.0 - clearance)*share for share in (0.5, 0.75, 1.0)]))
            self.write("free.nml", ring_on_elastic_pin(slave, angle, friction, clearance))
            with self.subTest(wave=wave, slave=slave, friction=friction):
                run = self.run_program("--output", "results", "free.nml", status=0 if angle else 2)
                self.assertEqual("no equilibrium" in run.stderr, not angle, run.stderr)
                self.assertEqual(self.run_program("--verify", "results").stdout, "free: verified\n")

    def test_body_lifted_from_a_bond_that_bears_shear_alone(self):
        self.assert_no_equilibrium(LIFTED.replace("friction", "slip_bound"),
                                   NO_EQUILIBRIUM + "translate along (0.0, 1.0)" + ADVICE)

    def test_sweep_names_a_ring_that_turns(self):
        for wave in (0.0, 0.01):
            self.write("ring.msh", ring(wave))
            self.write("sweep.nml", hung_ring(wave, 35, 1.0, (0.0, -1e-2))
                       + "&sweep friction = 0.05, 0.4 /\n")
            run = self.run_program("--output", "results", "sweep.nml")
            self.assertIn("2 cases, 1 solved, 1 without equilibrium", run.stdout)

    def test_cells_that_slide_along_a_plane(self):
        # A plug in a bore: pressed on it by 1 by heat alone, it bears less shear than the force along the axis is,
        # whichever multipliers the contact has.
        for multipliers in ("nodal", "constant"):
            with self.subTest(multipliers=multipliers):
                self.assert_no_equilibrium(block(
                    "support set = 'left'  ux = 0.0", "load temperature = 10.0", "load body_force = 0.0, 1.0",
                    f"contact set = 'right'  normal = -1.0, 0.0  point = 4.0, 0.0  friction = 0.1  "
                    f"multipliers = '{multipliers}'", material="young = 100.0  poisson = 0.25  expansion = 1e-5  "
                    "hypothesis = 'axisymmetric'"), SPINNING.format("translate along (0.0, 1.0)"),
                    is_seen_before=False)

    def test_stack_under_a_pressing_plate_slides_as_one(self):
        # Of two blocks of height 1, pressed by 1000 x 0.004/2 x 4 = 8 where all is closed, the lower one is pushed. The
        # upper one, free along x, goes along: friction bears 0.25 x 8 = 2, though it would bear 6.8 between the blocks.
        # On finer meshes the last corner opens, and presses the rest by 1e-5 more.
        stack = ("&mesh name = 'low'  size = 4.0, 1.0  cells = {}, 2 /\n&material young = 1000.0  poisson = 0.0 /\n"
                 "&mesh name = 'high'  size = 4.0, 1.0  cells = 5, 2  origin = 0.0, 1.0 /\n"
                 "&support set = 'high.top'  uy = -0.004 /\n&contact set = 'low.bottom'  friction = 0.25 /\n"
                 "&contact set = 'high.bottom'  against = 'low.top'  friction = {} /\n"
                 "&load name = 'push'  set = 'low.left'  traction = {}, 0.0 /\n")
        for cells, friction, excess, status in (
                (8, 0.6, -1e-3, 0), (8, 0.6, -1e-6, 0), (8, 0.6, 1e-6, 2), (8, 0.6, 1e-3, 2), (8, 0.6, 0.5, 2),
                (32, 0.25, 1e-6, 2)):
            self.write("stack.nml", stack.format(cells, friction, 2.0*(1.0 + excess)))
            run = self.run_program("--quiet", "--output", "results", "stack.nml", status=status)
            if status:
                self.assertIn(SPINNING.format("translate along (1.0, 0.0)").split("; the body")[0], run.stderr)
        self.write("sweep.nml", stack.format(8, 0.6, 2.0)
                   + "&sweep load = 'push'  factor = 0.5, 0.999999, 1.000001, 1.5 /\n")
        run = self.run_program("--output", "results", "sweep.nml")
        self.assertIn("4 cases, 2 solved, 2 without equilibrium", run.stdout)
        self.write("steps.nml", stack.format(8, 0.6, 2.0) + "&history times = 0.0, 1.0, 2.0 /\n"
                   "&steps load = 'push'  factor = 0.0, 0.99, 1.1 /\n")
        run = self.run_program("--output", "results", "steps.nml", status=2)
        self.assertIn("no equilibrium: all contact points slip", run.stderr)

    def test_body_is_lifted_off_its_floor_between_two_walls(self):
        # A body force of 1 presses the block against the right wall, another one lifts it along both. If the walls were
        # wedged apart far enough, friction would bear any load; that of the right wall bears 0.3, and a little more
        # where the body tilts and its upper corner meets the left one.
        for cells, excess, status in (("4, 4", -1e-9, 0), ("4, 4", 0.05, 0), ("4, 4", 0.1, 2), ("4, 4", 10.0, 2),
                                      ("4, 4", 100.0, 2), ("7, 5", 0.05, 0), ("7, 5", 0.1, 2),
                                      # Far away rounding leaves more than the tolerance of the residual.
                                      ("4, 4  element = 'tri6'", 1.0, 2)):
            text = block(f"load name = 'lift'  body_force = 1.0, {0.3*(1.0 + excess)!r}", CONTACT,
                         "contact set = 'right'  friction = 0.3  normal = -1.0, 0.0  point = 4.0, 0.0",
                         "contact set = 'left'  friction = 0.3  normal = 1.0, 0.0  point = 0.0, 0.0",
                         mesh=f"size = 4.0, 2.0  cells = {cells}", material="young = 1000.0  poisson = 0.25")
            self.write("lift.nml", text)
            run = self.run_program("--quiet", "--output", "results", "lift.nml", status=status)
            if status:
                self.assertIn(SPINNING.split(" {}")[0], run.stderr)
        self.write("sweep.nml", text + "&sweep load = 'lift'  factor = 0.0, 1.0 /\n")
        self.assertIn("2 cases, 1 solved, 1 without equilibrium", self.run_program("sweep.nml").stdout)

    def test_only_a_corner_of_a_curved_line_bears_a_body_that_tips(self):
        # The push at the top turns the block about its left corner: 32 of the pressure against 32 (1 + excess). The
        # wall at its right side, which it leaves, might bear any moment.
        self.write("arched.msh", arched_block(0.02))
        for excess, status in ((-0.01, 0), (1e-3, 2), (0.008, 2), (0.05, 2)):
            self.write("tip.nml", block(
                "load set = 'top'  pressure = 0.01", f"load set = 'top'  traction = {-0.005*(1.0 + excess)!r}, 0.0",
                "contact set = 'bottom'  friction = 1.0  slip_bound = 1e-9  point = 0.0, 0.0  normal = 0.0, 1.0",
                "contact set = 'right'  friction = 0.3  point = 8.0, 0.0  normal = -1.0, 0.0",
                mesh="file = 'arched.msh'", material="young = 1000.0  poisson = 0.0"))
            self.run_program("--quiet", "--output", "results", "tip.nml", status=status)

    def test_supports_along_a_line_that_is_nearly_a_circle_resist_the_motion_along_it(self):
        # Of motions along a flat parabola they leave one free but for a millionth; it strains the block a little.
        for rise in (1e-6, 1e-5, 2.54e-5, 3e-5, 1e-3, 0.1):
            self.write("arched.msh", arched_block(rise))
            self.write("guided.nml", block(
                "support set = 'bottom'  un = -1e-4", "load set = 'top'  pressure = 1e-3",
                "load set = 'right'  traction = -1e-4, -2e-4", "contact set = 'left'  extra_gap = -6e-4  "
                "point = 0.0, 0.0  normal = 1.0, 0.0", mesh="file = 'arched.msh'",
                material="young = 400.0  poisson = 0.25"))
            self.run_program("--quiet", "--output", "results", "guided.nml")

    def test_wall_bears_no_load_along_it_by_what_rounding_leaves_of_its_work(self):
        # A bolt lifts the middle one of three blocks, which nothing holds, beside a smooth wall of the upper one.
        self.write("bolt.nml", "".join(
            f"&mesh name = '{name}'  size = 8.0, 4.0  cells = {cells}  origin = 0.0, {bottom} /\n"
            for name, cells, bottom in (("a", "5, 3", 0.0), ("b", "8, 4", 4.0), ("d", "6, 3", 8.0)))
            + "&material young = 3000.0  poisson = 0.3 /\n&support set = 'd.top'  ux = 0.0  uy = 0.0 /\n"
            "&preload name = 'bolt'  set = 'd.bottom'  to = 'b.top'  force = 2.9 /\n"
            "&contact set = 'b.bottom'  against = 'a.top'  friction = 0.3 /\n"
            "&support set = 'a.bottom'  ux = 0.0  uy = 0.0 /\n"
            "&contact set = 'd.left'  normal = 1.0, 0.0  point = 0.0, 0.0 /\n")
        self.assertIn(NO_EQUILIBRIUM.split("the body")[0], self.run_program("--check", "bolt.nml", status=2).stderr)

    def test_loose_body_on_two_points_whose_stiffness_is_rounding(self):
        # Forces on the two points of the slave that face the master follow from the loads; the second one would enter
        # the master if the residual took its displacement times the stiffness of 1e-16 for the force that is missing.
        self.write("tip.nml", "&mesh name = 'b'  size = 1.8, 1.4  cells = 7, 2  element = 'quad4' /\n"
                   "&mesh name = 'd'  size = 1.2, 1.0  cells = 2, 1  element = 'quad8'  origin = -0.45, 1.4 /\n"
                   "&material young = 1e5  poisson = 0.2  hypothesis = 'plane strain' /\n"
                   "&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /\n"
                   "&load name = 'p'  set = 'd.top'  pressure = 10.0 /\n"
                   "&contact set = 'd.bottom'  against = 'b.top'  friction = 0.3  slip_bound = 3.0 /\n")
        self.run_program("--quiet", "--output", "results", "tip.nml")

    def test_rounding_of_a_load_across_a_motion_drives_nothing(self):
        # Without Poisson's ratio nothing but rounding acts along a smooth floor.
        for size in ("4.0, 2.0", "8.777, 10.941"):
            self.write("smooth.nml", block(
                "load set = 'top'  pressure = 0.7316397865198684", "contact set = 'bottom'",
                mesh=f"size = {size}  cells = 4, 5  element = 'quad4'",
                material="young = 3804.8075754166202  poisson = 0  hypothesis = 'plane stress'"))
            self.run_program("--quiet", "smooth.nml")

    def test_rounding_of_the_directions_of_supports_drives_nothing(self):
        # A load along the guides, far from the origin; along the wall nothing acts.
        for angle in (0.5, 3.0, 4.5, 5.0):
            def turned(x, y, angle=angle):
                return math.cos(angle)*x - math.sin(angle)*y, math.sin(angle)*x + math.cos(angle)*y

            def place(s, t, turned=turned):
                return tuple(map(sum, zip((3.0, -2.0), turned(0.01*s, 0.0025*t))))

            self.write("guided.msh", mapped_mesh((7, 4), "quad4", place, n_pressed=2))
            self.write("guided.nml", "&mesh file = 'guided.msh' /\n&material young = 1000.0  poisson = 0.3 /\n"
                       "&support set = 'pressed'  un = 0.0 /\n&load set = 'left'  traction = {!r}, {!r} /\n"
                       "&contact set = 'right'  friction = 0.3  point = {!r}, {!r}  normal = {!r}, {!r} /\n".format(
                           *turned(0.0, 1.0), *place(1.0, 0.0), *turned(-1.0, 0.0)))
            self.run_program("--quiet", "--output", "results", "guided.nml")

    def test_body_without_loads_does_not_spin(self):
        # On a round obstacle without friction; forces of 1e-15 would turn it.
        for cells, normal, gap in ((2, 0.0, -1e-5), (3, 0.002, 0.0), (7, 0.002, 0.0)):
            self.write("rest.nml", block(
                "load name = 'p'  set = 'top'  pressure = 0.01", "contact set = 'bottom'  obstacle = 'circle'  "
                f"radius = 200.0  point = 2.0, 0.0  normal = {normal}, 1.0  extra_gap = {gap}",
                "history times = 0.0, 1.0", "steps load = 'p'  factor = 0.0, 1.0",
                mesh=f"size = 4.0, 2.0  cells = {cells}, 3  element = 'quad9'"))
            self.run_program("--quiet", "--output", "results", "rest.nml")

    def test_steps_have_the_limit_of_single_cases(self):
        # Newton's method from the step before accepts a residual of 1e-10, above what the loads exceed friction by.
        for load, contact in (("body_force = 0.3, 0.0", "friction = 0.3"), ("body_force = 2.0, 0.0", "friction = 3.0")):
            text = block("load body_force = 0.0, -1.0", f"load name = 't'  {load}",
                         f"contact set = 'bottom'  {contact}", "history times = 0.0, 1.0  substeps = 1",
                         "steps load = 't'  factor = 0.5, {}",
                         mesh="size = 4.0, 2.0  cells = 6, 3")
            for factor, status in ((1.0 - 2e-11, 0), (1.0 + 2e-11, 2)):
                with self.subTest(load=load, factor=factor):
                    self.write("limit.nml", text.format(factor))
                    self.run_program("--quiet", "--output", "results", "limit.nml", status=status)

    def test_results_of_an_earlier_run_are_replaced(self):
        self.run_program("--output", "results", self.write("free.nml", SOUND))
        self.run_program("--output", "results", self.write("free.nml", LIFTED), status=2)
        self.assertEqual(sorted(self.contents("results")), ["free.deck.nml", "free.lst", "free.summary.json"])


if __name__ == "__main__":
    unittest.main()
