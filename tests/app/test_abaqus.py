#!/usr/bin/env python3
"""What a deck takes from an Abaqus or CalculiX file besides its mesh: the same case as a deck that says it itself."""
import unittest

from harness import PROGRAM, ProgramTest

MESH = """\
*HEADING
a block on the floor
*NODE, NSET=nall
1, 0., 0.
2, 1., 0.
3, 2., 0.
4, 0., 1.
5, 1., 1.
6, 2., 1.
*ELEMENT, TYPE={type}4, ELSET=eall
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*NSET, NSET=FLOOR
1, 2, 3
*NSET, NSET=Left
1, 4
*NSET, NSET=top
4, 5, 6
*ELSET, ELSET=right
2
*SURFACE, NAME=end
right, S2
"""
MATERIAL = """\
*MATERIAL, NAME=Steel
*ELASTIC
1000., .25
*DENSITY
0.5
*EXPANSION, ZERO=20.
1E-3
*SOLID SECTION, ELSET=EALL, MATERIAL=STEEL
2.
"""
SUPPORTS = "*BOUNDARY\n4, 1\nleft, 1, 1, 0.\n"
LOADS = """\
*STEP
*STATIC
*DLOAD
eall, P3, 5.
right, GRAV, 9.81, 0., -2., 0.
2, P3, 1.
*DSLOAD
end, P, 0.5
*CLOAD
6, 1, 3.
5, 1, 3.
top, 2, -1.
*NODE FILE
U
*END STEP
"""
USE = "&mesh kind = 'file'  file = 'block.inp'  use = {} /\n"
ALL = USE.format("'materials', 'supports', 'loads'")
CONTACT = "&contact set = 'FLOOR'  friction = 0.2 /\n"
PLAIN_MATERIAL = ("&material young = 1000.0  poisson = 0.25  hypothesis = '{}'  density = 0.5  expansion = 1e-3"
                  "  thickness = {} /\n")
PLAIN_SUPPORT = "&support set = 'Left'  ux = 0.0 /\n"
PLAIN_LOADS = """\
&load set = 'top'  pressure = 5.0 /
&load region = 'right'  gravity = 0.0, -9.81 /
&load set = 'end'  pressure = 0.5 /
&load point = 2.0, 1.0  force = 3.0, 0.0 /
&load point = 1.0, 1.0  force = 3.0, 0.0 /
&load set = 'top'  force = 0.0, -1.0 /
&load set = 'right top'  pressure = 1.0 /
"""
# A cube of two by two by one hexahedra, three times one on the other; the upper two are bonded.
CUBES = ("*PART, NAME=cube\n*NODE\n" + "".join(
    f"{1 + i + 3*j + 9*k}, {0.5*i}, {0.5*j}, {float(k)}\n" for k in range(2) for j in range(3) for i in range(3))
    + "*ELEMENT, TYPE=C3D8, ELSET=all\n" + "".join(
        f"{1 + i + 2*j}, " + ", ".join(str(1 + i + a + 3*(j + b) + 9*c) for a, b, c in (
            (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))) + "\n"
        for j in range(2) for i in range(2))
    + "*SURFACE, NAME=low\nall, S1\n*SURFACE, NAME=high\nall, S2\n*END PART\n*ASSEMBLY, NAME=a\n" + "".join(
        f"*INSTANCE, NAME={name}, PART=cube\n{0.1*z}, 0., {z}\n*END INSTANCE\n" for z, name in enumerate("ABC"))
    + "*TIE, NAME=t, POSITION TOLERANCE=0.1, ADJUST=NO\nC.low, B.high\n*END ASSEMBLY\n")
PAIR = ("*SURFACE INTERACTION, NAME=Rough\n1.,\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1E7\n"
        "*FRICTION\n0.2, 1E6\n*CONTACT PAIR, INTERACTION=rough, TYPE=SURFACE TO SURFACE\nB.low, A.high\n")
REFERENCE = (" cannot be used: points of reference of *RIGID BODY, *COUPLING and *PRE-TENSION SECTION become &rigid "
             "and &preload in the deck, with their forces and supports")
# Data lines that cannot be used, the keyword in front of them, what is used, and the message.
REFUSED = [
    ("*SOLID SECTION, ELSET=eall, MATERIAL=gold\n", "materials", "*SOLID SECTION: there is no material 'gold'"),
    ("*SOLID SECTION, ELSET=none, MATERIAL=gold\n", "materials", "*SOLID SECTION: there is no set 'none' above"),
    ("*SOLID SECTION, ELSET=eall\n", "materials", "*SOLID SECTION: expected MATERIAL= and the name of a material"),
    ("*MATERIAL\n", "materials", "expected NAME= and the name of a material"),
    ("*ELASTIC\n1., 2.\n", "materials", "*elastic before any *MATERIAL"),
    ("*MATERIAL, NAME=m\n*ELASTIC\n1.\n", "materials", "*elastic: expected 2 numbers"),
    ("*MATERIAL, NAME=m\n*ELASTIC\n1., soft\n", "materials", "expected a number, found 'soft'"),
    ("*MATERIAL, NAME=m\n*ELASTIC\n1., .2, 0.\n2., .2, 10.\n", "materials",
     "*elastic that depends on the temperature cannot be used"),
    ("*MATERIAL, NAME=m\n*ELASTIC, TYPE=ORTHO\n1., .2\n", "materials", "*ELASTIC with TYPE=ORTHO cannot be used"),
    ("*MATERIAL, NAME=m\n*SOLID SECTION, ELSET=eall, MATERIAL=m\n", "materials", "the material 'm' has no *ELASTIC"),
    ("*MATERIAL, NAME=m\n*ELASTIC\n1., .6\n*SOLID SECTION, ELSET=eall, MATERIAL=m\n", "materials",
     "poisson must lie above -1 and below 0.5, found 0.6"),
    ("*ELEMENT, TYPE=CPE3\n3, 1, 2, 4\n", "materials",
     "materials cannot be used: some elements are of type plane stress, others of plane strain"),
    ("*BOUNDARY\nnone, 1\n", "supports", "*BOUNDARY: there is no set 'none' above"),
    ("*BOUNDARY\nleft, up\n", "supports", "*BOUNDARY: expected the number of a component, found 'up'"),
    ("*BOUNDARY, OP=OLD\nleft, 1\n", "supports", "*BOUNDARY with OP=OLD cannot be used"),
    ("*BOUNDARY\n1, 1, 1, 0., 0., 0., 0., 0., 0., 7\n", "supports", "more than 9 fields on a line"),
    (f"*BOUNDARY\n{'x'*81}, 1\n", "supports", "a field of more than 80 characters"),
    ("*CLOAD\ntop, 3, 1.\n", "loads", "*CLOAD: expected a component from 1 to 2, found '3'"),
    ("*CLOAD\nnone, 1, 1.\n", "loads", "*CLOAD: there is no set 'none' above"),
    ("*CLOAD, AMPLITUDE=ramp\ntop, 1, 1.\n", "loads", "*CLOAD with AMPLITUDE=ramp cannot be used"),
    ("*DLOAD\nnone, P1, 1.\n", "loads", "*DLOAD: there is no set 'none' above"),
    ("*DLOAD,\neall, P3, 1.\n", "loads", "*DLOAD with eall cannot be used"),
    ("*DLOAD\n1, BX, 1.\n", "loads", "*dload: BX on the single element 1 cannot be used; name an element set"),
    ("*DLOAD\nnone, BX, 1.\n", "loads", "*dload: there is no set 'none' above"),
    ("*DLOAD\neall, P1NU, 1.\n", "loads", "*dload: loads of the kind 'P1NU' cannot be used"),
    ("*DLOAD\neall, GRAV, 1., 0., 0., -1.\n", "loads", "GRAV: expected a direction in the plane"),
    ("*DLOAD\neall, BZ, 1.\n", "loads", "BZ: the body is plane"),
    ("*DLOAD\neall, CENTRIF, -1., 0., 0., 0., 0., 0., 1.\n", "loads",
     "CENTRIF: the square of the angular speed is negative"),
    ("*DLOAD\neall, CENTRIF, 1., 0., 0., 0., 1., 0., 1.\n", "loads",
     "CENTRIF: expected an axis in the plane or normal to it"),
    ("*TEMPERATURE\nnone, 1.\n", "loads", "*TEMPERATURE: there is no node set 'none' above"),
    ("*TEMPERATURE\neall, 1.\n", "loads", "*TEMPERATURE: there is no node set 'eall' above"),
    ("*TEMPERATURE\n99, 1.\n", "loads", "*TEMPERATURE: there is no node 99 above"),
    ("*TEMPERATURE\nnall, hot\n", "loads", "expected a number, found 'hot'"),
    ("*TEMPERATURE\nnall, 1., 2.\n", "loads", "*TEMPERATURE: expected nodes and one temperature"),
    ("*TEMPERATURE, AMPLITUDE=ramp\nnall, 1.\n", "loads", "*TEMPERATURE with AMPLITUDE=ramp cannot be used"),
    ("*INITIAL CONDITIONS, TYPE=TEMPERATURE, USER\n", "loads", "*INITIAL CONDITIONS with USER cannot be used"),
    ("*STEP\n*END STEP\n*STEP\n", "loads", "a second *STEP: &mesh step = 2 uses the supports and loads of this "
     "one, and what it keeps of the first"),
    ("*DLOAD\neall, P3, 1.\n1, P2, 1.\n", "loads",
     "a load on 1 side inside the body, between two elements, cannot be used"),
    ("*NODE\n99, 9., 9.\n*CLOAD\n6, 2, 1.\n99, 2, 1.\n", "loads", "a load on 1 node of no element" + REFERENCE),
    ("*NODE\n99, 9., 9.\n*BOUNDARY\n99, 1\n", "supports", "a support of 1 node of no element" + REFERENCE),
    ("*STEP\n*STEP, PERTURBATION\n*STEP\n", "loads' step = 2 '", "*STEP with PERTURBATION cannot be used"),
    ("*STEP\n*CLOAD\ntop, 2, 1.\n*STEP\n*CLOAD\n5, 2, 1.\n", "loads' step = 2 '",
     "*cload after another load of its kind on a part of the same set or body in an earlier step cannot be used; "
     "end that by OP=NEW"),
    ("*STEP\n*DLOAD\neall, BX, 1.\n*STEP\n*DLOAD\nright, BX, 1.\n", "loads' step = 2 '",
     "*dload after another load of its kind on a part of the same set or body in an earlier step cannot be used; "
     "end that by OP=NEW"),
    ("*STEP\n", "loads' step = 2 '", "the file has no step 2, only 1"),
    ("*FRICTION\n0.1\n", "contact", "*FRICTION before any *SURFACE INTERACTION"),
    ("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.\n", "contact",
     "*SURFACE BEHAVIOR with PRESSURE-OVERCLOSURE=TIED cannot be used"),
    ("*SURFACE INTERACTION, NAME=i\n*FRICTION\n-0.1\n", "contact", "*FRICTION: the coefficient is negative"),
    ("*SURFACE INTERACTION, NAME=i\n*FRICTION, ROUGH\n", "contact", "*FRICTION with ROUGH cannot be used"),
    ("*SURFACE INTERACTION, NAME=i\n*FRICTION\n0.1\n0.2, , 5.\n", "contact",
     "*FRICTION that depends on pressure, slip or temperature cannot be used"),
    ("*CONTACT PAIR, INTERACTION=i, ADJUST=0.1\nend, top\n", "contact",
     "*CONTACT PAIR with ADJUST=0.1 cannot be used"),
    ("*CONTACT PAIR, INTERACTION=i\nend\n", "contact",
     "*CONTACT PAIR: expected two surfaces, the slave and the master"),
    ("*CONTACT PAIR, INTERACTION=i\nend, top\n", "contact", "there is no *SURFACE INTERACTION 'i'"),
    ("*TIE, NAME=t, POSITION TOLERANCE=-1.\nend, top\n", "contact", "*TIE: the position tolerance is negative"),
    ("*TIE, NAME=t\nend, side\n", "contact", "there is no surface 'side'"),
    ("*TIE, NAME=t, CYCLIC SYMMETRY\nend, top\n", "contact", "*TIE with CYCLIC SYMMETRY cannot be used"),
    ("*TRANSFORM, NSET=nall\n", "supports", "supports and loads in the directions of a *TRANSFORM cannot be used"),
]


class Abaqus(ProgramTest):
    """Materials, supports and loads of a mesh file."""

    def write_mesh(self, *parts, element="CPS"):
        """Writes the mesh file."""
        return self.write("block.inp", MESH.format(type=element) + "".join(parts))

    def assert_same(self, used, plain, element="CPS", parts=(MATERIAL, SUPPORTS, LOADS)):
        """Checks that two decks give the same results but for rounding, and that the files verify."""
        self.write_mesh("*SURFACE, NAME=right top\n2, S3\n", *parts, element=element)
        one, other = self.solve(used, "used"), self.solve(plain, "plain")
        # Loads that are summed in another order.
        scale = max(map(abs, other.forces))
        self.assert_close(one.forces, other.forces, 1e-13*scale)
        self.assert_close(one["slip"], other["slip"], 1e-13)
        self.assertEqual(one["status"], other["status"])
        self.assertIn("used: verified", self.run_program("--verify", ".").stdout)
        return one

    def test_everything_is_taken(self):
        self.assert_same(ALL + CONTACT, "&mesh kind = 'file'  file = 'block.inp' /\n"
                         + PLAIN_MATERIAL.format("plane stress", 2.0) + PLAIN_SUPPORT + PLAIN_LOADS + CONTACT)

    def test_body_of_revolution(self):
        self.assert_same(ALL + CONTACT, "&mesh kind = 'file'  file = 'block.inp' /\n"
                         + PLAIN_MATERIAL.format("axisymmetric", 1.0) + PLAIN_SUPPORT + PLAIN_LOADS
                         + "&load angular_speed = 2.0 /\n" + CONTACT, element="CAX", parts=(
                             MATERIAL, SUPPORTS, LOADS, "*DLOAD\neall, CENTRIF, 4., 0., 1., 0., 0., 1., 0.\n"))

    def test_deck_adds_to_what_is_taken(self):
        # A rotation about an axis in the plane and one normal to it, a force per volume; supports of one line each.
        self.assert_same(
            USE.format("'supports', 'loads'") + PLAIN_MATERIAL.format("plane strain", 1.0) + CONTACT
            + "&load set = 'top'  pressure = 30.0 /\n",
            "&mesh kind = 'file'  file = 'block.inp' /\n" + PLAIN_MATERIAL.format("plane strain", 1.0) + CONTACT
            + "&load set = 'top'  pressure = 30.0 /\n&support point = 0.0, 1.0  ux = 0.01  uy = -0.02 /\n"
            "&support point = 2.0, 1.0  uy = -0.02 /\n&support point = 1.0, 1.0  uy = 0.0 /\n"
            "&load angular_speed = 2.0  center = 0.5, 0.0 /\n"
            "&load angular_speed = 1.0  center = 1.0, 3.0  axis = 1.0, 0.0 /\n&load body_force = 1.0, -2.0 /\n",
            element="CPE", parts=(
                "*BOUNDARY\n4, 1, , 0.01\n4, 2, 2, -0.02\n6, 2, 2, -0.02\n5, YSYMM\n",
                "*DLOAD\neall, CENTRIF, 4., 0.5, 0., 0., 0., 0., 1.\n, CENTRIF, 1., 1., 3., 0., 1., 0., 0.\n"
                "eall, BX, 1.\neall, BY, -2.\n"))

    def test_supports_of_sides_hold_them_on_a_refined_mesh(self):
        self.write_mesh(MATERIAL, SUPPORTS.replace("4, 1\n", ""))
        press = "&load set = 'top'  pressure = 5.0 /\n&load set = 'end'  pressure = 3.0 /\n"
        used = self.solve(ALL.replace(" /", "  refine = 2 /") + press + CONTACT, "used")
        plain = self.solve("&mesh size = 2.0, 1.0  cells = 8, 4 /\n" + PLAIN_MATERIAL.format("plane stress", 2.0)
                           + "&support set = 'left'  ux = 0.0 /\n" + press.replace("end", "right")
                           + "&contact set = 'bottom'  friction = 0.2 /\n", "plain")
        # The same mesh, its nodes in another order.
        self.assert_close(used["contact_pressure"], plain["contact_pressure"], 1e-11)

    def test_temperatures_of_nodes_hold_on_a_refined_mesh(self):
        self.write_mesh(MATERIAL, SUPPORTS.replace("4, 1\n", ""))
        self.write("table.csv", "".join(f"{1 + i}, {3.0 + 2.0*(i % 3) - i//3}\n" for i in range(6)))
        deck = ALL.replace(" /", "  refine = 2 /") + CONTACT + "&load set = 'top'  pressure = 9.0 /\n&load "
        table = self.solve(deck + "temperature_table = 'table.csv' /\n", "table")
        slope = self.solve(deck + "temperature = 3.0  temperature_slope = 2.0, -1.0 /\n", "slope")
        # A linear field is what its values at the corners make of it.
        self.assert_close(table["contact_pressure"], slope["contact_pressure"], 1e-11)
        self.write("table.csv", "1, 1.0\n3, 1.0\n")
        run = self.run_program("--check", self.write("deck.nml", deck + "temperature_table = 'table.csv' /\n"),
                               status=1)
        self.assertIn("table.csv: no temperature of node 2", run.stderr)

    def test_temperatures_are_taken(self):
        # Of two lines for a node the later one counts; a node without a line keeps its initial temperature.
        parts = ("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nnall, 20.\n3, 25.\n", "*TEMPERATURE\ntop, 80.\n1, 30.\n"
                 "*TEMPERATURE, OP=MOD\n5, 95.\nfloor, 40.,\n")
        self.write("table.csv", "1, 20\n2, 20\n3, 15\n4, 60\n5, 75\n6, 60\n")
        heat = "&load temperature_table = 'table.csv' /\n"
        used = self.assert_same(ALL + CONTACT, "&mesh kind = 'file'  file = 'block.inp' /\n"
                                + PLAIN_MATERIAL.format("plane stress", 2.0) + PLAIN_SUPPORT + PLAIN_LOADS + heat
                                + CONTACT, parts=(MATERIAL, SUPPORTS, parts[0], LOADS, parts[1]))
        self.assertGreater(used.summary["key_results"]["max_displacement"], 0.05)
        self.assertNotIn("nothing is strained", (self.directory/"used.lst").read_text(encoding="utf-8"))

    def test_heated_block_between_walls(self):
        # Held along x at both ends and free to grow upwards: sigma_x = nu sigma_y - E alpha T, sigma_y = -p.
        self.write_mesh(MATERIAL, "*BOUNDARY\nleft, 1\n3, 1\n6, 1\n*DLOAD\neall, P3, 4.\n",
                        "*TEMPERATURE\nnall, 12.\n")
        case = self.solve(ALL + CONTACT.replace("0.2", "0.0"))
        along, across = 0.25*-4.0 - 1000.0*1e-3*12.0, -4.0
        self.assertAlmostEqual(case.summary["key_results"]["max_von_mises"],
                               (along**2 - along*across + across**2)**0.5, delta=1e-9)
        # Displacement at the top: height times strain.
        strain = (across - 0.25*along)/1000.0 + 1e-3*12.0
        self.assertAlmostEqual(case.summary["key_results"]["max_displacement"], strain, delta=1e-12)
        self.assertIn("Note                *TEMPERATURE without *INITIAL CONDITIONS, TYPE=TEMPERATURE: nothing is "
                      "strained at the temperature 0\n", (self.directory/"case.lst").read_text(encoding="utf-8"))

    def test_temperatures_need_an_expansion(self):
        self.write_mesh(MATERIAL.replace("*EXPANSION, ZERO=20.\n1E-3\n", ""), SUPPORTS, "*TEMPERATURE\nnall, 12.\n")
        warning = "warning: temperature has no effect: no material has a coefficient of thermal expansion\n"
        self.assertIn(warning, self.run_program("--check", self.write("deck.nml", ALL + CONTACT)).stdout)
        deck = USE.format("'supports', 'loads'") + CONTACT + PLAIN_MATERIAL.format("plane stress", 1.0)
        self.assertIn(warning, self.run_program(
            "--check", self.write("deck.nml", deck.replace("expansion = 1e-3", ""))).stdout)
        self.assertNotIn(warning, self.run_program("--check", self.write("deck.nml", deck)).stdout)

    def test_expansion_along_three_axes(self):
        # Free along x, held along z by nothing in plane stress: the strain is that of axis 2, which lies along x.
        axes = "*ORIENTATION, NAME=o\n0., 1., 0., -1., 0., 0.\n"
        self.write_mesh(axes, MATERIAL.replace("*EXPANSION, ZERO=20.\n1E-3\n", "*EXPANSION, TYPE=ORTHO\n1E-3, 2E-3,\n")
                        .replace("MATERIAL=STEEL", "MATERIAL=STEEL, ORIENTATION=o"),
                        "*BOUNDARY\nleft, 1\nfloor, 2\n*TEMPERATURE\nnall, 10.\n")
        case = self.solve(ALL)
        self.assertAlmostEqual(case.summary["key_results"]["max_displacement"], ((2.0*0.02)**2 + 0.01**2)**0.5,
                               delta=1e-12)
        self.assertAlmostEqual(case.summary["key_results"]["max_von_mises"], 0.0, delta=1e-10)

    def test_steps_keep_replace_and_end_what_was_given_before(self):
        # As common programs write steps: empty keywords with OP=NEW, blank fields, values given once more.
        steps = ["*BOUNDARY\nleft, 1, , \n4, 2, 2, 0.\n6, 2\n*STEP\n*STATIC\n*BOUNDARY, OP=NEW\n*CLOAD, op=New\n*DLOAD,"
                 " OP=NEW\n*BOUNDARY, OP=NEW\nleft, 1, ,\n4, 2, 2,\n6, 2, 2\n*CLOAD\ntop, 2, -1.\n6, 1, 2.\n5, 1, 2.\n"
                 "*DLOAD\neall, P3, 5.\neall, GRAV, 2., 0., -1.\n*END STEP\n",
                 "*STEP\n*BOUNDARY\n4, 2, 2, -0.01\n*CLOAD\n6, 1, 3.\ntop, 2, -4.\n*DLOAD\n1, P3, 7.\n"
                 "eall, GRAV, 1., 0., -1.\n*END STEP\n",
                 "*STEP, NLGEOM=NO\n*BOUNDARY, OP=NEW\nleft, 1\n*CLOAD, OP=NEW\n*DLOAD, OP=NEW\nright, P3, 6.\n"
                 "*END STEP\n"]
        plain = ("&mesh kind = 'file'  file = 'block.inp' /\n" + PLAIN_MATERIAL.format("plane stress", 2.0)
                 + PLAIN_SUPPORT + "&support point = 0.0, 1.0  uy = 0.0 /\n&support point = 2.0, 1.0  uy = 0.0 /\n")
        loads = ("&load set = 'top'  force = 0.0, -1.0 /\n&load point = 2.0, 1.0  force = 2.0, 0.0 /\n"
                 "&load point = 1.0, 1.0  force = 2.0, 0.0 /\n&load set = 'right top'  pressure = 5.0 /\n"
                 "&load set = 'left top'  pressure = 5.0 /\n&load gravity = 0.0, -2.0 /\n")
        changed = loads.replace("-1.0", "-4.0").replace("2.0, 1.0  force = 2.0", "2.0, 1.0  force = 3.0").replace(
            "'left top'  pressure = 5", "'left top'  pressure = 7").replace("0.0, -2.0", "0.0, -1.0")
        decks = [plain + loads, plain.replace("0.0, 1.0  uy = 0.0", "0.0, 1.0  uy = -0.01") + changed,
                 plain[:plain.index("&support point")] + "&load set = 'right top'  pressure = 6.0 /\n"]
        for n, deck in enumerate(decks, 1):
            with self.subTest(step=n):
                self.assert_same(ALL.replace(" /", f"  step = {n} /") + CONTACT, deck + CONTACT,
                                 parts=("*SURFACE, NAME=left top\n1, S3\n", MATERIAL, *steps))
                # Three lines of one pressure, or of one force on nodes, are one load.
                listing = (self.directory/"used.lst").read_text(encoding="utf-8")
                self.assertEqual(listing.count("\n  Load "), (4, 6, 1)[n - 1], listing)

    def test_contact_and_ties_are_taken(self):
        self.write("block.inp", CUBES + PAIR)
        body = ("&material young = 1000.0  poisson = 0.3 /\n&support set = 'A.low'  ux = 0.0  uy = 0.0  uz = 0.0 /\n"
                "&load set = 'C.high'  traction = 0.3, 0.1, -2.0 /\n")
        used = self.solve(USE.format("'contact'") + body, "used")
        self.assertIn("used: verified", self.run_program("--verify", ".").stdout)
        plain = self.solve("&mesh file = 'block.inp' /\n" + body
                           + "&tie set = 'C.low'  to = 'B.high'  search = 0.1 /\n"
                           "&contact set = 'B.low'  against = 'A.high'  friction = 0.2 /\n", "plain")
        self.assertEqual(used.forces, plain.forces)
        listing = (self.directory/"used.lst").read_text(encoding="utf-8")
        self.assertIn("surfaces in contact neither overlap nor creep", listing)
        self.assertIn("*CONTACT PAIR without SMALL SLIDING", listing)
        # Friction of the file is swept by the name of its slave.
        self.run_program("--quiet", self.write("sweep.nml", USE.format("'contact'") + body
                                               + "&sweep contact = 'B.low'  friction = 0.2, 0.5 /\n"))

    def test_loads_can_be_swept(self):
        self.write_mesh(MATERIAL, SUPPORTS, LOADS)
        self.run_program("--quiet", self.write("sweep.nml", ALL + CONTACT
                                               + "&sweep load = 'mesh file'  factor = 0.5, 1.0 /\n"))
        rows = (self.directory/"sweep.sweep.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(rows), 3)
        single = self.solve(ALL + CONTACT)
        self.assertAlmostEqual(float(rows[2].split(",")[rows[0].split(",").index("normal_force")]),
                               single.summary["resultants"]["normal_force"], delta=1e-8)

    def test_bodies_of_decks_that_use_the_file_differ(self):
        # The second deck has another material than the file's: their factorizations are not shared.
        self.write_mesh(MATERIAL, SUPPORTS, LOADS)
        self.write("one.nml", ALL + CONTACT)
        self.write("two.nml", USE.format("'supports', 'loads'") + PLAIN_MATERIAL.format("plane stress", 3.0) + CONTACT)
        self.run_program("--quiet", "one.nml", "two.nml")
        self.assertNotIn("factorization of", (self.directory/"two.lst").read_text(encoding="utf-8"))

    def test_what_is_ignored_is_named(self):
        self.write_mesh(MATERIAL, SUPPORTS, LOADS)
        plain = "&mesh kind = 'file'  file = 'block.inp' /\n" + PLAIN_MATERIAL.format("plane stress", 2.0) \
            + PLAIN_SUPPORT + CONTACT
        expected = ("warning: not read from the mesh file: *MATERIAL, *ELASTIC, *DENSITY, *EXPANSION, *SOLID SECTION, "
                    "*BOUNDARY, *STEP, *DLOAD, *DSLOAD, *CLOAD; give them in the deck, or &mesh use = 'materials', "
                    "'supports', 'loads'\n")
        self.assertIn(expected, self.run_program("--check", self.write("plain.nml", plain)).stdout)
        self.assertNotIn("warning", self.run_program("--check", self.write("used.nml", ALL + CONTACT)).stdout)
        linear = "*STEP, NLGEOM=NO"
        self.write_mesh(MATERIAL, SUPPORTS, LOADS.replace("*STEP", linear))
        self.assertIn(expected.replace("*STEP", linear), self.run_program("--check", "plain.nml").stdout)
        self.assertNotIn("warning", self.run_program("--check", "used.nml").stdout)
        self.write_mesh(MATERIAL, SUPPORTS, LOADS)
        self.solve(ALL + CONTACT)
        self.assertIn("4 keywords ignored (not mesh data): *HEADING, *STATIC, *NODE FILE, *END STEP\n",
                      (self.directory/"case.lst").read_text(encoding="utf-8"))
        for lines, named in (("*CONTACT PAIR, INTERACTION=i\na, b\n", "*CONTACT PAIR; give them in the deck, or "
                              "&mesh use = 'contact'"),
                             ("*STEP, NLGEOM\n*DYNAMIC\n1.\n*END STEP\n", "*STEP, NLGEOM, *DYNAMIC"),
                             ("*BASE MOTION, DOF=1\n*FIELD\n1, 2.\n", "*BASE MOTION, *FIELD"),
                             ("*NODAL THICKNESS\n1, 2.\n", "*NODAL THICKNESS"),
                             ("*INITIAL CONDITIONS, TYPE=STRESS\n1, 2.\n", "*INITIAL CONDITIONS, TYPE=STRESS"),
                             ("*DISTRIBUTING COUPLING\n1\n*GASKET BEHAVIOR\n1.\n*PRESSURE PENETRATION\n1.\n",
                              "*DISTRIBUTING COUPLING, *GASKET BEHAVIOR, *PRESSURE PENETRATION"),
                             ("*TEMPERATURE\nnall, 2.\n", "*TEMPERATURE; give them in the deck, or &mesh use = "
                              "'loads'")):
            self.write_mesh(SUPPORTS, lines)
            run = self.run_program("--check", self.write(
                "part.nml", USE.format("'supports'") + PLAIN_MATERIAL.format("plane stress", 2.0) + CONTACT))
            self.assertIn(f"warning: not read from the mesh file: {named}\n", run.stdout)

    def test_what_cannot_be_used_is_refused(self):
        for lines, use, message in REFUSED:
            with self.subTest(lines=lines):
                self.write_mesh(lines)
                use = f"'{use}'".replace(" ''", "")
                deck = USE.format(use) + ("" if use == "'materials'" else PLAIN_MATERIAL.format("plane stress", 1))
                run = self.run_program("--check", self.write("deck.nml", deck + CONTACT), status=1)
                self.assertRegex(run.stderr, r"^deck.nml:1: \S*block.inp:\d+: ")
                self.assertTrue(run.stderr.endswith(f": {message}\n"), run.stderr)
                # Of what is not used nothing is read.
                self.write("deck.nml", deck.replace(f"use = {use}", "") + PLAIN_MATERIAL.format("plane stress", 1)
                           + CONTACT)
                if "TYPE=CPE3" not in lines:
                    self.assertNotIn("block.inp:", self.run_command([PROGRAM, "--check", "deck.nml"], None).stderr)
        self.write("deck.nml", USE.format("'materials'").replace("block.inp", "none.inp") + CONTACT)
        self.assertIn("none.inp", self.run_program("--check", "deck.nml", status=1).stderr)

    def test_rotation_of_a_body_of_revolution_about_another_axis(self):
        self.write_mesh("*DLOAD\neall, CENTRIF, 1., 1., 0., 0., 0., 1., 0.\n", element="CAX")
        deck = USE.format("'loads'") + PLAIN_MATERIAL.format("axisymmetric", 1) + CONTACT
        self.assertIn("CENTRIF: a body of revolution spins about its own axis", self.run_program(
            "--check", self.write("deck.nml", deck), status=1).stderr)

    def test_names_of_results_hold_no_folder(self):
        self.write("part.inc", "*BOUNDARY\n1, 1, 2\n3, 2\n")
        self.write_mesh(MATERIAL, "*INCLUDE, INPUT=part.inc\n")
        names = self.solve(ALL + "&load set = 'top'  pressure = 1.0 /\n").summary["key_results"]
        self.assertNotIn(str(self.directory), str(names))
        self.assertIn("reaction_x_*BOUNDARY:part.inc:2", " ".join(names))

    def test_set_inside_the_body_cannot_bear_contact(self):
        body = PLAIN_MATERIAL.format("plane stress", 1)
        for lines, message in (
                ("*SURFACE, NAME=joint\n1, S2\n", "lies inside the body: the elements on both sides share its nodes, "
                 "and nothing can act, open or slip there; mesh two bodies without common nodes, each with a set of "
                 "its own"),
                ("*NSET, NSET=joint\n2, 5\n", "has nodes, but no side of the boundary lies between them; where both "
                 "sides of a line share its nodes, it lies inside the body")):
            self.write_mesh(lines)
            deck = self.write("deck.nml", "&mesh file = 'block.inp' /\n" + body + "&contact set = 'joint' /\n")
            run = self.run_program("--check", deck, status=1)
            self.assertIn(f"deck.nml:3: the set 'joint' {message}\n", run.stderr)

    def test_use_is_for_files_of_abaqus(self):
        self.write("square.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n")
        for deck, message in ((USE.format("'loads'").replace("block.inp", "square.msh"),
                               "materials, supports, loads and contact can be used of Abaqus and CalculiX files only"),
                              ("&mesh size = 1.0, 1.0  cells = 1, 1  use = 'loads' /\n",
                               "use is only for kind = 'file'"),
                              (USE.format("'load'"), "use: expected one of 'materials', 'supports', 'loads', "
                               "'contact', found 'load'"),
                              (USE.format("3"), "use: expected one of 'materials', 'supports', 'loads', 'contact', "
                               "found 3")):
            run = self.run_program("--check", self.write("deck.nml", deck + PLAIN_MATERIAL.format("plane stress", 1)
                                                         + CONTACT), status=1)
            self.assertIn(message, run.stderr)


if __name__ == "__main__":
    unittest.main()
