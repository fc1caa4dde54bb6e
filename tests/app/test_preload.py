#!/usr/bin/env python3
"""Preloads: bars and the bolt diagram, bolts that contact alone holds on one side, balances, and what is refused."""
import csv
import unittest

from harness import ProgramTest
from mapped_mesh import mapped_mesh
from mapped_solid import mapped_solid

# A bar of 1 x 4 in two pieces, E = 100, whose meshes do not match, along y.
BAR = """&mesh name = 'a'  size = 1.0, 1.5  cells = 2, 3  element = '{element}' /
&mesh name = 'b'  size = 1.0, 2.5  cells = {across}, 4  origin = 0.0, 1.5  element = '{element}' /
&material young = 100.0  poisson = {poisson} /
&support name = 'foot'  set = 'a.bottom'  uy = 0.0 {guide} /
"""
PRELOAD = "&preload name = 'bolt'  set = 'b.bottom'  to = 'a.top'  {} /\n"
# Bolt and sleeve under a head: springs in parallel, of stiffness k = E A/L.
SLEEVE = BAR.format(element="quad4", across=3, poisson=0.0, guide="ux = 0.0") + """
&mesh name = 's'  size = 2.0, 4.0  cells = 2, 2  origin = 3.0, 0.0 /
&material young = 30.0  poisson = 0.0  region = 's' /
&support name = 'base'  set = 's.bottom'  ux = 0.0  uy = 0.0 /
"""
HEAD = "&rigid name = 'head'  set = 'b.top, s.top'  ux = 0.0  turn = 0.0  force = 0.0, {} /\n"
K_BOLT, K_SLEEVE = 100.0/4.0, 30.0*2.0/4.0
# A lid on two bolts: screwed into a block, the heads one with the lid.
LID = """&mesh name = 'block'  size = 10.0, 2.0  cells = 10, 2 /
&mesh name = 'lid'  size = 10.0, 2.0  cells = 11, 2  origin = 0.0, 2.0 /
&mesh name = 'p'  size = 1.0, 1.0  cells = 2, 2  origin = -1.5, 0.0 /
&mesh name = 'q'  size = 1.0, 1.0  cells = 2, 2  origin = 10.5, 0.0 /
&mesh name = 'pu'  size = 1.0, 3.0  cells = 2, 6  origin = -1.5, 1.0 /
&mesh name = 'qu'  size = 1.0, 3.0  cells = 2, 6  origin = 10.5, 1.0 /
&material young = 1000.0  poisson = 0.3 /
&rigid name = 'lower'  set = 'block.bottom, p.bottom, q.bottom'  ux = 0.0  uy = 0.0  turn = 0.0 /
&rigid name = 'upper'  set = 'lid.top, pu.top, qu.top'  force = 0.0, {load} /
&contact name = 'seal'  set = 'lid.bottom'  against = 'block.top'  friction = 0.2 /
&preload name = 'left'  set = 'pu.bottom'  to = 'p.top'  {left} /
&preload name = 'right'  set = 'qu.bottom'  to = 'q.top'  {right} /
"""
# A screw whose head presses on a flange, around the axis; the screw is held at its foot.
SCREW = """&mesh name = 'foot'  size = 1.0, 4.0  cells = 2, 8 /
&mesh name = 'top'  size = 1.0, 4.0  cells = 2, 8  origin = 0.0, 4.0 /
&mesh name = 'head'  size = 3.0, 2.0  cells = 6, 4  origin = 0.0, 8.0 /
&mesh name = 'flange'  size = 4.0, 8.0  cells = 8, 16  origin = 1.5, 0.0 /
&material young = 1e4  poisson = 0.3  hypothesis = 'axisymmetric' /
&support set = 'foot.bottom'  uy = 0.0 /
&support name = 'ground'  set = 'flange.bottom'  uy = 0.0 /
&support set = 'foot.left'  ux = 0.0 /
&support set = 'top.left'  ux = 0.0 /
&support set = 'head.left'  ux = 0.0 /
&tie set = 'top.top'  to = 'head.bottom' /
&contact name = 'seat'  set = 'head.bottom'  against = 'flange.top'  friction = 0.1 /
&preload name = 'screw'  set = 'top.bottom'  to = 'foot.top'  {} /
"""
# Of solids of 1 x 1.2 x 4 along z, E = 100; the cut is at z = 1.5.
PRISM = """&mesh name = 'a'  kind = 'box'  size = 1.0, 1.2, 1.5  cells = 2, 2, 2  element = '{}' /
&mesh name = 'b'  kind = 'box'  size = 1.0, 1.2, 2.5  cells = 3, 2, 3  origin = 0.0, 0.0, 1.5  element = '{}' /
&material young = 100.0  poisson = {poisson} /
&support name = 'foot'  set = 'a.bottom'  ux = 0.0  uy = 0.0  uz = 0.0 /
"""


def turned(x, y, z):
    """A vector by its components along (2, -2, -1)/3, (-1, -2, 2)/3 and (-2, -1, -2)/3."""
    return [(2*x - y - 2*z)/3, (-2*x - 2*y - z)/3, (-x + 2*y - 2*z)/3]


def cross(a, b):
    """The vector product."""
    return [a[(k + 1) % 3]*b[(k + 2) % 3] - a[(k + 2) % 3]*b[(k + 1) % 3] for k in range(3)]


class Preload(ProgramTest):
    """The key results of preloads."""

    def key(self, text, name="case"):
        """The key results of a deck, once the certificate has passed and the files are verified."""
        summary = self.solve(text, name).summary
        self.assertTrue(summary["certificate"]["passed"])
        self.run_program("--verify", ".")
        return summary["key_results"]

    def listing(self):
        """The listing of the last deck."""
        return (self.directory/"case.lst").read_text(encoding="utf-8")

    def rows(self, ending):
        """The rows of a table."""
        with open(self.directory / ending, newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table))

    def test_bar_shortens_by_force_times_length_over_stiffness(self):
        for element in "tri3", "quad4", "tri6", "quad8", "quad9":
            for across in 2, 3:
                bar = BAR.format(element=element, across=across, poisson=0.0, guide="ux = 0.0") \
                    + "&support set = 'b.top'  ux = 0.0  uy = 0.0 /\n"
                with self.subTest(element=element, across=across):
                    key = self.key(bar + PRELOAD.format("force = 5.0"))
                    self.assert_close([key["preload_bolt_shortening"], key["preload_bolt_force"],
                                       key["reaction_y_foot"]], [5.0*4.0/100.0, 5.0, -5.0], 1e-12)
                    self.assertIn("bolt: preload at 'b.bottom', shortening under force = 5.0\n", self.listing())
                    key = self.key(bar + PRELOAD.format("shortening = 0.2"))
                    self.assert_close([key["preload_bolt_shortening"], key["preload_bolt_force"],
                                       key["reaction_y_foot"]], [0.2, 5.0, -5.0], 1e-12)
                    self.assertIn("bolt: preload at 'b.bottom', shortening = 0.2\n", self.listing())

    def test_guided_bar_and_one_along_x(self):
        guided = BAR.format(element="quad4", across=2, poisson=0.3, guide="") + "".join(
            f"&support set = '{body}.{side}'  ux = 0.0 /\n" for body in "ab" for side in ("left", "right")) \
            + "&support set = 'b.top'  uy = 0.0 /\n"
        key = self.key(guided + PRELOAD.format("force = 5.0"))
        self.assertAlmostEqual(key["preload_bolt_shortening"], 5.0*4.0/100.0*1.3*0.4/0.7, delta=1e-13)
        lying = """&mesh name = 'a'  size = 1.5, 1.0  cells = 3, 2 /
&mesh name = 'b'  size = 2.5, 1.0  cells = 4, 3  origin = 1.5, 0.0 /
&material young = 100.0  poisson = 0.0  thickness = 0.5 /
&support set = 'a.left'  ux = 0.0  uy = 0.0 /
&support set = 'b.right'  ux = 0.0  uy = 0.0 /
&preload name = 'bolt'  set = 'a.right'  to = 'b.left'  force = 5.0 /
"""
        self.assertAlmostEqual(self.key(lying)["preload_bolt_shortening"], 0.4, delta=1e-13)

    def test_shear_and_moment_of_the_cut_are_those_of_a_beam(self):
        beam = """&mesh name = 'foot'  size = 1.0, 4.0  cells = 4, 8  element = '{0}' /
&mesh name = 'shank'  size = 1.0, 6.0  cells = 5, 12  origin = 0.0, 4.0  element = '{0}' /
&material young = 1e5  poisson = 0.0 /
&support set = 'foot.bottom'  ux = 0.0  uy = 0.0 /
&rigid name = 'top'  set = 'shank.top'  uy = 0.0  force = 0.3, 0.0  moment = 0.7 /
"""
        for element in "quad4", "quad8":
            for drive in "force = 2.0", "shortening = 0.001":
                for cut in "set = 'shank.bottom'  to = 'foot.top'", "set = 'foot.top'  to = 'shank.bottom'":
                    text = beam.format(element) + f"&preload name = 'bolt'  {cut}  {drive} /\n"
                    # Exerted on the slave, along the tangent to its outward normal.
                    sign = -1.0 if "set = 'foot" in cut else 1.0
                    with self.subTest(element=element, drive=drive, cut=cut):
                        key = self.key(text)
                        self.assert_close([key["tie_tangential_bolt"], key["tie_moment_bolt"]],
                                          [-0.3, sign*(0.3*6.0 - 0.7)], 1e-9)

    def test_solid_bar_shortens_by_force_times_length_over_stiffness(self):
        for elements in ("hex8", "hex8"), ("tet4", "hex8"), ("tet10", "hex20"), ("hex20", "tet10"):
            for drive in "force = 6.0", "shortening = 0.2":
                with self.subTest(elements=elements, drive=drive):
                    key = self.key(PRISM.format(*elements, poisson=0.0)
                                   + "&support set = 'b.top'  ux = 0.0  uy = 0.0  uz = 0.0 /\n" + PRELOAD.format(drive))
                    self.assert_close([key[f"preload_bolt_{k}"] for k in ("shortening", "force")], [0.2, 6.0], 1e-12)
                    self.assert_close([key[f"reaction_{k}_foot"] for k in "xyz"], [0.0, 0.0, -6.0], 1e-12)
                    self.assert_close([key[f"tie_{k}_bolt"] for k in ("x", "y", "z", "moment_x", "moment_y",
                                                                      "moment_z")], [0.0]*6, 1e-12)

    def test_shear_and_moments_of_a_solid_cut_balance_what_acts_beyond_it(self):
        force = turned(0.3, -0.2, 0.0)
        middle, arm = turned(0.0, 0.0, 1.5), turned(0.0, 0.0, 2.5)
        for element in "hex8", "tet10":
            for name, cells, low, high in (("a", (2, 2, 2), 0.0, 1.5), ("b", (3, 2, 3), 1.5, 4.0)):
                self.write(f"{name}.msh", mapped_solid(
                    cells, element, lambda r, s, t, z=low, h=high - low: turned(r - 0.5, 1.2*s - 0.6, z + h*t)))
            for drive in "force = 2.0", "shortening = 0.001":
                for cut, sign in (("set = 'b.bottom'  to = 'a.top'", 1.0), ("set = 'a.top'  to = 'b.bottom'", -1.0)):
                    key = self.key(f"""&mesh name = 'a'  file = 'a.msh' /
&mesh name = 'b'  file = 'b.msh' /
&material young = 1e3  poisson = 0.3 /
&support set = 'a.bottom'  ux = 0.0  uy = 0.0  uz = 0.0 /
&support name = 'top'  set = 'b.top'  un = 0.0 /
&load set = 'b.top'  total_force = {", ".join(map(str, force))} /
&preload name = 'bolt'  {cut}  {drive} /
""")
                    held, moment, shear, bending = (
                        [key[f"{what}_{k}_{name}"] for k in "xyz"] for what, name in (
                            ("reaction", "top"), ("reaction_moment", "top"), ("tie", "bolt"), ("tie_moment", "bolt")))
                    # Those of the support and of the load about the middle of the cut.
                    beyond = [m - p + q for m, p, q in zip(moment, cross(middle, held), cross(arm, force))]
                    with self.subTest(element=element, drive=drive, cut=cut):
                        self.assert_close(shear, [-sign*f for f in force], 1e-9)
                        self.assert_close(bending, [-sign*m for m in beyond], 1e-9)
                        pull = sum(p*q for p, q in zip(held, turned(0.0, 0.0, 1.0)))
                        self.assertAlmostEqual(key["preload_bolt_force"], pull, delta=1e-9)

    def test_layer_of_a_solid_is_the_plane_with_a_cut_aslant(self):
        # Parallelograms: the normal of the cut is (-0.3, 1)/sqrt(1.09). Of plane strain, one cell deep.
        low, high = (lambda r, s: (r, 0.3*r + 1.5*s)), (lambda r, s: (r, 0.3*r + 1.5 + 2.5*s))
        names = {"front": "bottom", "back": "top", "bottom": "below", "top": "above"}
        for name, cells, place in ("a", (3, 4, 1), low), ("b", (4, 5, 1), high):
            self.write(f"{name}.msh", mapped_solid(cells, "hex8", lambda r, s, t, at=place: (*at(r, s), 0.5*t),
                                                   lambda side, _: names.get(side, side)))
            self.write(f"{name}2.msh", mapped_mesh(cells[:2], "quad4", place))
        deck = """&mesh name = 'a'  file = 'a{0}.msh' /
&mesh name = 'b'  file = 'b{0}.msh' /
&material young = 100.0  poisson = 0.3  {1} /
&support name = 'foot'  set = 'a.bottom'  ux = 0.0  uy = 0.0 /
&support name = 'top'  set = 'b.top'  ux = 0.0  uy = 0.0 /
&preload name = 'bolt'  set = 'b.bottom'  to = 'a.top'  {2} /
"""
        guides = "".join(f"&support set = '{body}.{side}'  uz = 0.0 /\n" for body in "ab"
                         for side in ("below", "above"))
        for drive in "force = 2.0", "shortening = 0.1":
            plane = self.key(deck.format("2", "thickness = 0.5", drive))
            layer = self.key(deck.format("", "", drive) + guides)
            for key in "preload_bolt_force", "preload_bolt_shortening", "reaction_x_foot", "reaction_y_top":
                self.assertAlmostEqual(layer[key], plane[key], delta=1e-9)

    def test_bolt_diagram(self):
        load, preload = 3.0, 5.0
        key = self.key(SLEEVE + HEAD.format(load) + PRELOAD.format(f"force = {preload}"))
        # A given force stays in the bolt, whatever pulls the head.
        self.assert_close([key["preload_bolt_force"], key["rigid_head_uy"], key["reaction_y_base"],
                           key["preload_bolt_shortening"]],
                          [preload, (load - preload)/K_SLEEVE, preload - load,
                           preload/K_BOLT + (preload - load)/K_SLEEVE], 1e-12)
        # With a given shortening bolt and sleeve share the load like springs.
        shortening = preload/K_BOLT + preload/K_SLEEVE
        key = self.key(SLEEVE + HEAD.format(load) + PRELOAD.format(f"shortening = {shortening!r}"))
        share = K_BOLT/(K_BOLT + K_SLEEVE)
        self.assert_close([key["preload_bolt_force"], key["reaction_y_base"]],
                          [preload + share*load, preload - (1 - share)*load], 1e-12)

    def test_screw_on_a_flange_that_contact_holds(self):
        key = self.key(SCREW.format("force = 50.0"))
        self.assert_close([key["force_normal_seat"], key["reaction_y_ground"], key["preload_screw_force"]],
                          [50.0, 50.0, 50.0], 1e-9)
        shortening = key["preload_screw_shortening"]
        key = self.key(SCREW.format(f"shortening = {shortening!r}"))
        self.assertAlmostEqual(key["force_normal_seat"], 50.0, delta=1e-8)
        # The head is pulled off: the bolt bears all.
        text = SCREW.format("shortening = 1e-4") + "&load set = 'head.top'  total_force = 0.0, 60.0 /\n"
        key = self.key(text)
        self.assert_close([key["force_normal_seat"], key["preload_screw_force"]], [0.0, 60.0], 1e-9)

    def test_lid_on_two_bolts(self):
        key = self.key(LID.format(load=-1.0, left="force = 3.0", right="force = 5.0"))
        self.assertAlmostEqual(key["force_normal_seal"], 9.0, delta=1e-9)
        # But for the bending of the bolts, the moment of both about the middle is that of the pressure.
        self.assertAlmostEqual(key["contact_centroid_x"], 5.0 + (5.0 - 3.0)*6.0/9.0, delta=0.01)
        shortenings = [f"shortening = {key[f'preload_{bolt}_shortening']!r}" for bolt in ("left", "right")]
        again = self.key(LID.format(load=-1.0, left=shortenings[0], right="force = 5.0"))
        self.assertAlmostEqual(again["preload_left_force"], 3.0, delta=1e-8)
        again = self.key(LID.format(load=-1.0, left=shortenings[0], right=shortenings[1]))
        self.assert_close([again["preload_left_force"], again["preload_right_force"]], [3.0, 5.0], 1e-8)

    def test_columns_of_sweeps_and_steps(self):
        self.run_program("--quiet", self.write("sweep.nml", SCREW.format(
            "force = 50.0") + "&sweep load = 'screw'  factor = 0.5, 1.0 /\n"
            "&output key_results = 'forces'  fields_every = 1 /\n"))
        self.run_program("--verify", ".")
        rows = self.rows("sweep.sweep.csv")
        for row, factor in zip(rows, (0.5, 1.0)):
            self.assertAlmostEqual(float(row["preload_screw_force"]), 50.0*factor, delta=1e-10)
            self.assertAlmostEqual(float(row["force_normal_seat"]), 50.0*factor, delta=1e-9)
        self.assertAlmostEqual(float(rows[0]["preload_screw_shortening"]),
                               0.5*float(rows[1]["preload_screw_shortening"]), delta=1e-12)
        head = "&rigid name = 'head'  set = 'head.top'  uy = 0.001 /\n"
        history = "&history times = 0.0, 1.0, 2.0  substeps = 2 /\n"
        self.key(SCREW.format("shortening = 0.02") + head + history +
                 "&steps support = 'screw'  factor = 0.0, 1.0, 1.0 /\n"
                 "&steps support = 'head'  factor = 0.0, 0.0, 1.0 /\n", "history")
        rows = self.rows("history.history.csv")
        for row in rows:
            factor = min(1.0, float(row["time"]))
            self.assertAlmostEqual(float(row["preload_screw_shortening"]), 0.02*factor, delta=1e-14)
            self.assertAlmostEqual(float(row["rigid_head_uy"]), 0.001*max(0.0, float(row["time"]) - 1.0), delta=1e-14)
            # What the screw pulls the seat and the head's holder bear.
            self.assertAlmostEqual(float(row["preload_screw_force"]), float(row["force_normal_seat"])
                                   + float(row["rigid_head_force_y"]), delta=1e-9)
        self.assertGreater(float(rows[-1]["rigid_head_force_y"]), 1.0)

    def test_end_of_a_free_preload_that_nothing_holds(self):
        # The upper half moves along the bolt; the floor holds the lower one.
        body = BAR.format(element="quad4", across=3, poisson=0.3, guide="").replace(
            "name = 'foot'  set = 'a.bottom'  uy = 0.0", "name = 'foot'  set = 'a.left'  ux = 0.0") + (
            "&load name = 'press'  set = 'b.top'  pressure = {} /\n&contact set = 'a.bottom' /\n")
        history = "&history times = 0.0, 1.0, 2.0 /\n&steps load = 'press'  factor = 0.0, 1.0, 1.0 /\n"
        free = "the body is free to move along the preload on one side of it"
        loose = f"{free}: nothing holds it; add a support or a contact set\n"
        for keys, steps, message in (
                ("force = 1.0", "", f"no equilibrium: contact and friction cannot balance the loads; {free}; add a "),
                ("force = 1.0", history, loose),
                ("force = 1.0  lock_time = 1.0", history, loose)):
            self.write("case.nml", body.format(4.0) + PRELOAD.format(keys) + steps)
            run = self.run_program("case.nml", status=2)
            self.assertTrue(run.stderr.startswith(f"case.nml: {message}"), run.stderr)

    def test_refused(self):
        bar = BAR.format(element="quad4", across=2, poisson=0.0, guide="ux = 0.0")
        top = "&support set = 'b.top'  ux = 0.0  uy = 0.0 /\n"
        for text, status, words in (
                (bar + top + PRELOAD.format(""), 1, "&preload needs either force or shortening"),
                (bar + top + PRELOAD.format("force = 1.0  shortening = 0.1"), 1, "either force or shortening"),
                (bar + top + PRELOAD.format("force = 1.0").replace("a.top", "a.topp"), 1, "did you mean 'a.top'"),
                (bar + top + PRELOAD.format("force = 1.0").replace("a.top", "b.bottom"), 1, "must name another set"),
                (bar + top + PRELOAD.format("force = 1.0").replace("a.top", "b.top"), 1, "face"),
                (bar + top + 2*PRELOAD.format("force = 1.0"), 1, "another rigid set or preload has the name 'bolt'"),
                (bar + top + PRELOAD.format("force = 1.0").replace("bolt", "bolt_of_the_flange"), 1, "at most 16"),
                (bar + top + "&support set = 'b.bottom'  uy = 0.0 /\n" + PRELOAD.format("force = 1.0"), 1,
                 "supports hold the slave 'b.bottom'"),
                (bar + top + "&support set = 'b.bottom'  uy = 0.0 /\n&support set = 'a.top'  ux = 0.0  uy = 0.0 /\n"
                 + PRELOAD.format("force = 1.0"), 1,
                 "supports hold all nodes of 'b.bottom' along its normal, or guide them aslant"),
                (bar + PRELOAD.format("force = 1.0"), 2, "free to move along the preload on one side of it"),
                (PRISM.format("hex8", "tet10", poisson=0.0) + PRELOAD.format("force = 1.0"), 2,
                 "the body is free to move along the preload on one side of it"),
                (SCREW.format("force = -1.0"), 2, "free to move along the preload on one side of it")):
            with self.subTest(words=words):
                run = self.run_program("--quiet", self.write("case.nml", text), status=status)
                self.assertIn(words, run.stderr)

    def test_a_side_that_only_the_preload_holds_is_refused_before_the_factorization(self):
        # The loads balance the force of the bolt. The stiffness is singular, as rounding may hide: in the case, in a
        # sweep and in steps that lock the bolt.
        text = (BAR.format(element="quad4", across=2, poisson=0.0, guide="ux = 0.0")
                + "&load name = 'pull'  set = 'b.top'  pressure = -1.0 /\n"
                "&contact set = 'a.right'  normal = -1.0, 0.0  point = 1.0, 0.0 /\n")
        for study in (PRELOAD.format("force = 1.0"),
                      PRELOAD.format("force = 1.0") + "&sweep load = 'pull'  factor = 0.5, 1.0 /\n",
                      PRELOAD.format("force = 1.0  lock_time = 1.0") + "&history times = 0.0, 1.0, 2.0 /\n"):
            run = self.run_program("--quiet", self.write("case.nml", text + study), status=2)
            self.assertIn("free to move along the preload on one side of it: nothing holds it", run.stderr)

    def test_nothing_is_left_to_compute(self):
        text = """&mesh size = 1.0, 1.0  cells = 1, 1 /
&material young = 1.0  poisson = 0.3 /
&support set = 'top'  ux = 0.0  uy = 0.0 /
&support set = 'bottom'  ux = 0.0  uy = 0.1 /
"""
        run = self.run_program("--quiet", self.write("case.nml", text), status=1)
        self.assertIn("prescribe the displacements of all nodes", run.stderr)


if __name__ == "__main__":
    unittest.main()
