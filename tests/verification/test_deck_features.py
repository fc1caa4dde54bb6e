#!/usr/bin/env python3
"""What a deck may say beyond the long bar's, each against a closed form that the elements contain exactly."""
import math
import unittest

from harness import ProgramTest, read_vtu
from mapped_mesh import mapped_mesh

# A column 1 wide of two layers, each of one cell 1 high, its sides and layers named; written as MSH 2.2.
COLUMN = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
5
1 1 "floor"
1 2 "sides"
1 3 "roof"
2 4 "soft"
2 5 "stiff"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1 0 0
3 0 1 0
4 1 1 0
5 0 2 0
6 1 2 0
$EndNodes
$Elements
8
1 1 2 1 1 1 2
2 1 2 2 2 2 4
3 1 2 2 2 4 6
4 1 2 2 2 5 3
5 1 2 2 2 3 1
6 1 2 3 3 6 5
7 3 2 4 1 1 2 4 3
8 3 2 5 2 3 4 6 5
$EndElements
"""
# Results of some ten operations on numbers of about 1, with condition numbers below 1e3.
ROUNDING = 1e-12


def confined_modulus(young, poisson):
    """Stress over strain along y where nothing may move along x, in plane strain."""
    return young*(1 - poisson)/((1 + poisson)*(1 - 2*poisson))


class DeckFeatures(ProgramTest):
    """One feature of a deck each."""

    def test_gaps_of_a_polyline_are_those_of_its_segments(self):
        # A roof over s = -1 to 1, turned by 90 degrees: its normal is (1, 0), s counts along -y from (-0.5, 1).
        self.write("roof.csv", "# a roof\ns; h\n-2; -0.3\n-1; 0\n0; 0.25\n1; 0\n2; -0.3\n")
        result = self.solve("""\
&mesh size = 4.0, 2.0  cells = 4, 8 /
&material young = 100.0  poisson = 0.25 /
&support set = 'right'  ux = 0.0  uy = 0.0 /
&load set = 'top'  traction = 0.0, 1.0e-9 /
&contact set = 'left'  obstacle = 'polyline'  line = 'roof.csv'  point = -0.5, 1.0  normal = 1.0, 0.0 /
""")
        self.assertEqual(set(result["status"]), {"open"})
        expected = [0.5 - 0.25*(1 - abs(y - 1.0)) for y in result["y"]]
        # The load keeps the certificate from dividing by zero; it moves the nodes by less than 1e-9.
        self.assert_close(result["gap"], expected, 1e-9)

    def test_polyline_on_a_plane_gives_the_forces_of_the_plane(self):
        self.write("line.csv", "-9 0\n-1.3, 0\n0.2;0\n9\t0\n")
        deck = """\
&mesh size = 4.0, 2.0  cells = 8, 4 /
&material young = 100.0  poisson = 0.25 /
&support set = 'left'  ux = 0.0 /
&support set = 'top'  uy = -0.2 /
&contact set = 'bottom'  friction = 0.3  obstacle = %s  point = 2.0, -0.05  normal = 0.02, 1.0 /
"""
        plane = self.solve(deck % "'plane'", "plane")
        polyline = self.solve(deck % "'polyline'  line = 'line.csv'", "polyline")
        self.assertGreater(len(set(plane["status"])), 1)
        self.assertEqual(polyline["status"], plane["status"])
        self.assert_close(polyline.forces, plane.forces, ROUNDING*max(plane["normal_force"]))

    def test_friction_and_bound_follow_their_tables(self):
        self.write("friction.csv", "station, coefficient\n1.0, 0.1\n3.0, 0.3\n")
        self.write("bound.csv", "0 0.2\n2 0.05\n4 0.1\n")
        deck = """\
&mesh size = 4.0, 2.0  cells = 8, 4 /
&material young = 100.0  poisson = 0.25 /
&support set = 'left'  ux = 0.0 /
&load set = 'top'  pressure = 1.0 /
&load set = 'right'  pressure = 60.0 /
&contact set = 'bottom'  %s_table = '%s.csv' /
"""
        def sliding(result):
            rows = zip(result["x"], result["contact_pressure"], result["contact_shear"], result["status"])
            return [row[:3] for row in rows if row[3] == "slip-"]

        coulomb = sliding(self.solve(deck % ("friction", "friction")))
        self.assertGreater(len(coulomb), 4)
        # Constant beyond the ends of the table, linear between; the line begins at x = 0.
        self.assert_close([shear/pressure for _, pressure, shear in coulomb],
                          [-min(max(0.1*x, 0.1), 0.3) for x, *_ in coulomb], ROUNDING)
        tresca = sliding(self.solve(deck % ("slip_bound", "bound")))
        self.assertGreater(len(tresca), 4)
        self.assert_close([shear for *_, shear in tresca],
                          [-(0.2 - 0.075*x if x < 2 else 0.025*x) for x, *_ in tresca], ROUNDING)

    def test_gaps_of_a_slope_and_a_table_are_those_of_a_tilted_plane(self):
        # Below the node at x the tilted plane is 0.02 x - 0.05 away along the normal, the flat one what the deck says.
        self.write("gaps.csv", "length; gap\n0; -0.05\n4; 0.03\n")
        deck = """\
&mesh size = 4.0, 2.0  cells = 8, 4  element = 'quad8' /
&material young = 100.0  poisson = 0.25 /
&support set = 'left'  ux = 0.0 /
&support set = 'top'  uy = 0.0 /
&contact set = 'bottom'  friction = 0.3  multipliers = '{}'  {} /
{}
"""
        ways = {"slope": "extra_gap = -0.05  gap_slope = 0.02, 0.0", "table": "gap_table = 'gaps.csv'"}
        history = "&history times = 0.0, 1.0 /\n&steps obstacle = 'bottom'  shift_y = 0.0, 0.005 /"
        for multipliers in "nodal", "constant":
            for study in "", history:
                plane = self.solve(deck.format(multipliers, "point = 0.0, 0.05  normal = 0.02, 1.0", study), "plane")
                self.assertGreater(len(set(plane["status"])), 1)
                for name, way in ways.items():
                    with self.subTest(multipliers=multipliers, way=name, study=study):
                        result = self.solve(deck.format(multipliers, way, study), name)
                        self.assertEqual(result["status"], plane["status"])
                        self.assert_close(result["gap"], plane["gap"], ROUNDING)
                        # The tilted plane's normal is another way into it, along which the friction cannot tell.
                        self.assert_close(result.forces, plane.forces, ROUNDING*max(plane["normal_force"]))
        self.run_program("--quiet", "--verify", ".")

    def test_gaps_of_a_pair_follow_their_table(self):
        # Too far away to touch: what is left is the gap of the meshes, 0.5, and the mean of the table over a cell or,
        # of a corner between sides one long, over its shape function, whose middle at both ends lies 1/3 inside.
        self.write("gaps.csv", "0 0.1\n4 0.3\n")
        deck = """\
&mesh name = 'a'  size = 4.0, 1.0  cells = 4, 2 /
&mesh name = 'b'  size = 6.0, 1.0  cells = 7, 2  origin = -1.0, -1.5 /
&material young = 100.0  poisson = 0.25 /
&support set = 'a.top'  ux = 0.0  uy = 0.0 /
&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /
&load set = 'a.left'  traction = 0.0, 1.0e-9 /
&contact set = 'a.bottom'  against = 'b.top'  multipliers = '%s'  gap_table = 'gaps.csv' /
"""
        for multipliers in "mortar", "constant":
            result = self.solve(deck % multipliers, multipliers)
            self.assertEqual(set(result["status"]), {"open"})
            # The load moves no node by more than 1e-9.
            middles = [min(max(x, 1/3), 11/3) for x in result["x"]]
            self.assert_close(result["gap"], [0.6 + 0.05*x for x in middles], 1e-9, multipliers)
        self.run_program("--quiet", "--verify", ".")

    def test_gaps_close_along_the_direction_given(self):
        # A block between two parallel lines that rise by 0.5 along x, vertical sides free, pressed by a vertical
        # traction p on its top: the stress along y is -p/cos a, and no other. The floor 0.1 below it, in vertical
        # measure, may push along y alone, whatever its slope.
        young, poisson, pressure, rise, gap = 1000.0, 0.3, 2.0, 0.5, 0.1
        cosine = 1/math.hypot(1, rise)
        self.write("block.msh", mapped_mesh((6, 4), "quad4", lambda s, t: (3*s, 2*t + rise*3*s)))
        result = self.solve(f"""\
&mesh kind = 'file'  file = 'block.msh' /
&material young = {young}  poisson = {poisson} /
&support point = 0.0, 0.0  ux = 0.0 /
&load set = 'top'  traction = 0.0, {-pressure} /
&contact set = 'bottom'  point = 0.0, {-gap}  normal = {-rise}, 1.0  gap_direction = 0.0, -3.0 /
""")
        n = len(result["x"])
        self.assert_close(result["normal_x"] + result["normal_y"], [0.0]*n + [-1.0]*n, ROUNDING)
        self.assert_close(result["contact_pressure"], [pressure]*n, ROUNDING*100)
        self.assert_close(result["gap"], [0.0]*n, ROUNDING)
        # Along the bottom u_y = -gap, so the block turns by -eps_y rise, and u_x = (eps_x + eps_y rise^2) x.
        stress = -pressure/cosine
        across, along = -poisson*(1 + poisson)*stress/young, (1 - poisson**2)*stress/young
        self.assert_close(result["slip"], [(across + along*rise**2)*x for x in result["x"]], ROUNDING)

    def test_layers_of_a_column_give_way_one_by_one(self):
        self.write("column.msh", COLUMN)
        moduli = confined_modulus(100.0, 0.25), confined_modulus(700.0, 0.1)
        for regions in (("soft", "stiff"), ("soft", None)):
            second = f"region = '{regions[1]}'" if regions[1] else ""
            result = self.solve(f"""\
&mesh kind = 'file'  file = 'column.msh' /
&material young = 100.0  poisson = 0.25  region = 'soft' /
&material young = 700.0  poisson = 0.1  {second} /
&support set = 'sides'  ux = 0.0 /
&support set = 'roof'  uy = -0.1 /
&contact set = 'floor' /
""")
            pressure = 0.1/(1/moduli[0] + 1/moduli[1])
            self.assert_close(result["contact_pressure"], [pressure]*2, ROUNDING*pressure)

    def test_foundation_gives_way_along_normal_and_tangent(self):
        self.write("column.msh", COLUMN)
        # The floor rises by 0.1 into a column that springs hold at its roof: springs and column in a row.
        result = self.solve("""\
&mesh kind = 'file'  file = 'column.msh' /
&material young = 100.0  poisson = 0.25 /
&support set = 'sides'  ux = 0.0 /
&support set = 'roof'  spring_n = 40.0 /
&contact set = 'floor'  extra_gap = -0.1 /
""")
        pressure = 0.1/(1/40.0 + 2/confined_modulus(100.0, 0.25))
        self.assert_close(result["contact_pressure"], [pressure]*2, ROUNDING*pressure)
        # Springs along the roof bear its shear: the column moves by shear over stiffness, without any strain.
        result = self.solve("""\
&mesh kind = 'file'  file = 'column.msh' /
&material young = 100.0  poisson = 0.0 /
&support set = 'roof'  spring_t = 40.0 /
&load set = 'roof'  traction = 3.0, -5.0 /
&contact set = 'floor' /
""")
        self.assert_close(result["slip"], [3.0/40.0]*2, ROUNDING)
        self.assert_close(result["contact_pressure"], [5.0]*2, ROUNDING*100)

    def test_temperatures_of_a_region_strain_it_alone(self):
        # Two layers, one on the other between roof and floor: the lower one wants to be longer by 1e-3.
        self.write("column.msh", COLUMN)
        deck = """\
&mesh kind = 'file'  file = 'column.msh' /
&material young = 100.0  poisson = 0.0  region = 'soft'  expansion = 1e-5 /
&material young = 400.0  poisson = 0.0  region = 'stiff'  expansion = 1e-3 /
&support set = 'sides'  ux = 0.0 /
&support set = 'floor'  uy = 0.0 /
&support set = 'roof'  uy = 0.0 /
&load name = 'heat'  region = 'soft'  temperature = 60.0  temperature_slope = 0.0, 80.0 /
"""
        result = self.solve(deck)
        arrays, _, _ = read_vtu((self.directory/"case.vtu").read_bytes())
        # The means of the layers give in by stress over modulus.
        stress = -1e-3/(1/100 + 1/400)
        for tensor in arrays["stress"]:
            self.assertAlmostEqual(tensor[1], stress, delta=ROUNDING)
        # Across y the lower layer cannot expand at all; along y its strain varies by 4e-4 to either side of the mean.
        variance = (4e-4)**2/3
        energy = 0.5*stress**2*(1/100 + 1/400) + 0.5*100*(2*(1e-3**2 + variance) + variance)
        self.assertAlmostEqual(result.summary["certificate"]["strain_energy"], energy, delta=ROUNDING)

    def test_faults_of_a_temperature_table(self):
        deck = """\
&mesh size = 1.0, 1.0  cells = 1, 1 /
&material young = 100.0  poisson = 0.25  expansion = 1e-5 /
&support set = 'left'  ux = 0.0  uy = 0.0 /
&load temperature_table = 'table.csv' /
"""
        file = self.directory.resolve()/"table.csv"
        wrong_number = "temperature_table must have the number of a node, 1 or above, in each row"
        for rows, fault in (("1, 5\n2, 5\n4, 5\n", f"{file}: no temperature of node 3"),
                            ("1, 5\n2, 5\n3, 5\n4, 5\n2, 6\n", f"{file}: node 2 is given a second time"),
                            ("1, 5\n1.5, 5\n", wrong_number), ("0, 5\n1, 5\n", wrong_number)):
            self.write("table.csv", rows)
            run = self.run_program("--check", self.write("deck.nml", deck), status=1)
            self.assertEqual(run.stderr, f"deck.nml:4: {fault}\n")
        run = self.run_program("--check", self.write("deck.nml", deck.replace("&load", "&load temperature = 3.0 ")),
                               status=1)
        self.assertIn("give either temperature and temperature_slope, or temperature_table", run.stderr)


if __name__ == "__main__":
    unittest.main()
