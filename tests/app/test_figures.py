"""What figures of cases show: obstacles, magnified gaps, uniform fields, units; and the options of the command."""
import base64
import re
import struct
import sys
import unittest
import zlib
from pathlib import Path

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block, words_of

try:
    import matplotlib
    import numpy as np
    from matplotlib.colors import ListedColormap
except ImportError:
    print("skipped: Matplotlib and NumPy are not installed")
    sys.exit(0)

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
# pylint: disable=wrong-import-position
from amontons.cases import Case  # noqa: E402
from amontons.draw_body import initial_gaps, magnification, magnification_at, surfaces  # noqa: E402
from amontons.draw_steps import draw_zones  # noqa: E402
from amontons.numerals import scientific  # noqa: E402
from amontons.obstacles import hatching, surface  # noqa: E402
from amontons.raster import cell_image, color_numbers  # noqa: E402
from amontons.report import cell_text  # noqa: E402
from amontons.svg_axes import SvgAxes  # noqa: E402
# pylint: enable=wrong-import-position

matplotlib.use("Agg")
WINDOW = np.array([[-1.0, -2.0], [5.0, 3.0]])
PUNCH = ("support set = 'top'  ux = 0.0  uy = -0.01",
         "contact set = 'bottom'  friction = 0.2  obstacle = 'circle'  radius = 3.0  point = 2.0, 0.0")


def text_of(svg):
    """The words of a picture: they are text, not outlines of letters."""
    return re.findall(r"<text[^>]*>([^<]*)</text>", svg.read_text(encoding="utf-8"))


class Numerals(ProgramTest):
    """Numbers in texts of pictures and reports, beside the program's own."""

    def test_moduli_in_a_report_have_an_exponent_from_a_million_on(self):
        values = (0.0, 0.0123456, 1.0e-8, 205000.0, 7251687.0, 2.1e11, 9999999999.0)
        self.assertEqual([cell_text(value) for value in values],
                         ["0", "0.012346", "1.0e-8", "205000", "7.2517e6", "2.1e11", "1e10"])

    def test_they_have_the_form_of_the_listing(self):
        for value, text in ((0.704, "0.704"), (1730.2, "1730.0"), (1e-8, "1.0e-8"), (2.0549e-11, "2.05e-11"),
                            (0.0, "0.0"), (-3.0e-5, "-3.0e-5"), (1e17, "1.0e17")):
            self.assertEqual(scientific(value), text)
        self.solve(block(SUPPORT, PRESSURE, CONTACT))
        listing = (self.directory / "case.lst").read_text(encoding="utf-8")
        certificate = Case(self.directory / "case").summary["certificate"]
        for label, name in (("Equilibrium", "equilibrium"), ("Energy balance", "energy")):
            self.assertEqual(re.search(rf"^  {label} +(\S+)", listing, re.MULTILINE)[1], scientific(certificate[name]))


class Obstacles(ProgramTest):
    """The lines that obstacles are drawn as."""

    def test_every_kind_is_drawn_and_no_other(self):
        file = self.directory / "line.csv"
        file.write_text("s,h\n-1,0\n1,0\n", encoding="utf-8")
        placed = {"point": [0.0, 0.0], "normal": [0.0, 1.0], "radius": 2.0, "line": str(file)}
        of_solids = {"sphere", "cylinder", "paraboloid", "surface"}
        for kind in {*words_of("contact", "obstacle")} - of_solids:
            self.assertGreater(len(surface({**placed, "obstacle": kind}, WINDOW)), 1, kind)
        with self.assertRaisesRegex(ValueError, "obstacle 'cusp' cannot be drawn"):
            surface({**placed, "obstacle": "cusp"}, WINDOW)

    @staticmethod
    def local(contact):
        """The points of an obstacle in its frame, s and h."""
        normal = np.array(contact["normal"]) / np.hypot(*contact["normal"])
        line = surface(contact, WINDOW) - contact["point"]
        return line @ [normal[1], -normal[0]], line @ normal

    def test_points_are_on_the_surface(self):
        placed = {"point": [1.0, -0.5], "normal": [-1.0, 2.0]}
        s, h = self.local({**placed, "obstacle": "plane"})
        np.testing.assert_allclose(h, 0.0, atol=1e-14)  # rounding
        for radius in (2.0, -2.0, 1e5):
            s, h = self.local({**placed, "obstacle": "parabola", "radius": radius})
            np.testing.assert_allclose(h, -s**2 / (2 * radius), atol=1e-13)
            s, h = self.local({**placed, "obstacle": "circle", "radius": radius})
            # on the circle through the point, to the rounding of its radius
            np.testing.assert_allclose(np.hypot(s, h + radius), abs(radius), rtol=1e-14)
            self.assertTrue((np.diff(s)[len(s)//2 - 9:len(s)//2 + 9] > 0).all())

    def test_curved_lines_are_smooth_in_the_window(self):
        for radius in (0.1, 10.0, 1e5):
            line = surface({"obstacle": "circle", "radius": radius, "point": [0.0, 0.0], "normal": [0.0, 1.0]}, WINDOW)
            self.assertLess(np.hypot(*np.diff(line, axis=0).T).max(), 0.05)

    def test_a_polyline_is_read_as_the_program_reads_it(self):
        with self.subTest("comments, a heading, any separator"):
            file = Path(self.id())
            file.write_text("# a comment\ns, h\n0.0 0.0\n1.0;2d-1\n\n2.0\t0.5, 7\n", encoding="utf-8")
            self.addCleanup(file.unlink)
            contact = {"obstacle": "polyline", "line": str(file), "point": [1.0, 1.0], "normal": [0.0, -1.0]}
            # s counts along (n_y, -n_x) = (-1, 0), h along (0, -1)
            np.testing.assert_allclose(surface(contact, WINDOW), [[1.0, 1.0], [0.0, 0.8], [-1.0, 0.5]], atol=1e-15)

    def test_hatching_is_on_the_solid_side(self):
        for kind, radius in (("plane", None), ("circle", 2.0), ("circle", -2.0), ("parabola", 1.0)):
            contact = {"obstacle": kind, "radius": radius, "point": [2.0, 0.0], "normal": [0.0, 1.0]}
            strokes = hatching(surface(contact, WINDOW), WINDOW, 0.1)
            self.assertGreater(len(strokes), 20)
            s, h = (strokes[:, 1] - contact["point"]).T
            depth = -h if kind == "plane" else np.where(np.sign(radius) > 0, -h - (s**2 + (kind == "circle")*h**2) / (
                2*radius), np.hypot(s, h + radius) - abs(radius))
            self.assertGreater(depth.min(), 0.0, (kind, radius))


class Images(unittest.TestCase):
    """The images of fields in reports."""

    def test_a_pixel_has_the_color_of_the_cell_that_its_middle_is_in(self):
        # A square of 7 by 7 pixels, a rotated one that it is cut out of, in four triangles without seams between them.
        window, size = np.array([[-1.0, -1.0], [1.0, 1.0]]), (7, 7)
        corners = np.array([[0.9, 0.3], [-0.3, 0.9], [-0.9, -0.3], [0.3, -0.9]])
        triangles = np.stack([corners, np.roll(corners, -1, axis=0), np.zeros((4, 2))], axis=1)
        image = cell_image([(triangles, np.array([1, 2, 3, 4]))], window, size)
        x, y = np.meshgrid((np.arange(7) + 0.5)*2/7 - 1, 1 - (np.arange(7) + 0.5)*2/7)
        for row, column in np.ndindex(*image.shape):
            at = np.array([x[row, column], y[row, column]])
            inside = [i + 1 for i, (a, b, c) in enumerate(triangles) if all(
                np.cross(q - p, at - p) >= 0.0 for p, q in ((a, b), (b, c), (c, a)))]
            # A middle on the side between two cells belongs to one of them.
            self.assertIn(image[row, column], inside or [0], (row, column))

    def test_cells_outside_of_the_window_are_cut_off(self):
        square = np.array([[[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]])
        image = cell_image([(square, np.array([5])), (square + 30.0, np.array([6]))], WINDOW, (12, 10))
        self.assertEqual((image.shape, np.unique(image).tolist()), ((10, 12), [5]))

    def test_a_pixel_of_a_map_has_the_color_of_its_cell(self):
        axes, x, y = SvgAxes(10.0, 20.0, 106.0, 68.0), np.array([0.0, 1.0, 4.0]), np.array([0.0, 2.0, 3.0])
        colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [9, 9, 9]])
        axes.pcolormesh(x, y, np.array([[0.0, 1.0], [np.nan, 3.0]]), cmap=ListedColormap(colors/255), vmin=-0.5,
                        vmax=3.5)
        data = base64.b64decode(re.search(r'base64,([^"]*)"', axes.image_of_cells("name")[0])[1])
        self.assertEqual(struct.unpack(">II", data[16:24]), (200, 100))
        start = data.index(b"IDAT")
        size, = struct.unpack(">I", data[start - 4:start])
        rows = np.frombuffer(zlib.decompress(data[start + 4:start + 4 + size]), np.uint8).reshape(100, 201)[:, 1:]
        # The upper row is a third of the height, the left column a fourth of the width; 0 is transparent.
        self.assertEqual([np.unique(part).tolist() for part in (
            rows[:33, :50], rows[:33, 50:], rows[34:, :50], rows[34:, 50:])], [[0], [4], [1], [2]])
        table = data.index(b"PLTE") + 4
        self.assertEqual(list(data[table:table + 15]), [0, 0, 0, *colors.ravel()])

    def test_powers_of_ten_are_where_a_logarithmic_ordinate_has_them(self):
        axes = SvgAxes(0.0, 0.0, 100.0, 100.0)
        axes.set_yscale("log")
        axes.plot([1, 2, 3], [2.0, 3e-3, 5e-4], color="black")
        self.assertEqual(axes.ylim, (-4.0, 1.0))
        self.assertAlmostEqual(axes.y(1e-4), 100.0)
        self.assertAlmostEqual(axes.y(1.0), 20.0)
        texts = re.findall(r'y="([\d.]+)"[^>]*>10([⁻⁰¹²³⁴]+)<', axes.frame())
        self.assertEqual(texts, [("103", "⁻⁴"), ("83", "⁻³"), ("63", "⁻²"), ("43", "⁻¹"), ("23", "⁰"), ("3", "¹")])

    def test_colors_are_between_the_limits(self):
        self.assertEqual(color_numbers(np.array([-1.0, 0.0, 0.5, 1.0, 2.0]), 0.0, 1.0).tolist(), [1, 1, 128, 255, 255])


class Figures(ProgramTest):
    """Figures of solved cases."""

    def solve(self, *groups, **options):
        """Solves a block."""
        self.write("block.nml", block(*groups, **options))
        self.run_program("--quiet", "block.nml")
        return Case(self.directory / "block")

    def plot(self, *arguments, status=0):
        """Runs the command."""
        return self.run_package("plot", *arguments, status=status)

    def test_closed_points_lie_on_the_obstacle_at_any_magnification(self):
        case = self.solve(*PUNCH, mesh="size = 4.0, 2.0  cells = 40, 8")
        line = case.line
        closed = line.point_data["status"] > 1
        self.assertGreater(closed.sum(), 2)
        for factor in (3.0, 50.0):
            drawn, = surfaces(case, factor, WINDOW)
            at = line.points[:, :2] + factor*line.point_data["displacement"][:, :2]
            # along the normal; along the obstacle they have slipped
            np.testing.assert_allclose(at[closed, 1], drawn[closed[np.isfinite(initial_gaps(case))], 1], atol=1e-12)
            open_ = ~closed & np.isfinite(initial_gaps(case))
            np.testing.assert_allclose(at[open_, 1] - (line.points[:, 1] - factor*initial_gaps(case))[open_],
                                       factor*line.point_data["gap"][open_], rtol=1e-9)
        # as it is, the obstacle is the circle of the deck
        true, = surfaces(case, 1.0, WINDOW)
        np.testing.assert_allclose(np.hypot(true[:, 0] - 2.0, true[:, 1] + 3.0), 3.0, rtol=1e-14)
        self.assertEqual(magnification(case), 1.0)

    def test_flat_contact_is_magnified(self):
        case = self.solve(SUPPORT, PRESSURE, CONTACT)
        self.assertGreater(magnification(case), 1.0)
        drawn, = surfaces(case, 100.0, WINDOW)
        np.testing.assert_allclose(drawn[:, 1], 0.0, atol=1e-15)

    def test_of_a_pair_both_bodies_are_drawn_and_no_obstacle(self):
        name = self.write("pair.nml", block(
            "mesh name = 'b'  size = 6.0, 2.0  cells = 9, 3  origin = -1.0, -2.01", "support set = 'b.left'  ux = 0.0",
            "support set = 'left'  ux = 0.0", PRESSURE, "contact set = 'bottom'  against = 'b.top'",
            "contact set = 'b.bottom'  point = 0.0, -2.01"))
        self.run_program("--quiet", name)
        case = Case(self.directory / "pair")
        # Of 9 slave points the gaps of the meshes, of the 10 on the obstacle none.
        np.testing.assert_allclose(initial_gaps(case), [0.01]*9 + [0.0]*10, atol=1e-12)
        self.assertEqual((len(case.line.points), len(case.master.points)), (19, 10))
        found, = surfaces(case, 1.0, WINDOW)
        np.testing.assert_allclose(found[:, 1], -2.01)
        self.plot("pair", "--format", "svg")

    def test_bodies_that_close_an_overlap_are_not_drawn_apart(self):
        # A hub whose hole is smaller than the shaft by 0.002 [L] in radius: it moves outwards by about as much.
        fit = "contact set = 'hub.left'  against = 'shaft.right'  gap = 'touching'  extra_gap = {}"
        groups = ("mesh name = 'hub'  size = 1.0, 2.0  cells = 4, 8  origin = 1.0, 0.0",
                  *(f"support set = '{name}.bottom'  uy = 0.0" for name in ("shaft", "hub")))
        parts = {"mesh": "name = 'shaft'  size = 1.0, 2.0  cells = 4, 8",
                 "material": "young = 100.0  poisson = 0.25  hypothesis = 'axisymmetric'"}
        case = self.solve(*groups, fit.format(-0.001), **parts)
        self.assertGreater(np.abs(case.mesh.point_data["displacement"]).max(), 5e-4)
        for factor in (magnification(case), magnification_at(case, np.arange(5))):
            self.assertLessEqual(factor*0.001, 1e-3*2.0)
        # Without an overlap, pressed together.
        case = self.solve(*groups, fit.format(0.0), "load set = 'hub.right'  pressure = 0.1", **parts)
        self.assertGreater(magnification(case), 10.0)

    def test_zones_of_contact_sets_have_a_gap_between_them(self):
        case = self.solve(SUPPORT, "load name = 'p'  set = 'top'  pressure = 1.0",
                          "contact name = 'floor'  set = 'bottom'",
                          "contact set = 'right'  point = 4.1, 0.0  normal = -1.0, 0.0", "history times = 0.0, 1.0",
                          "steps load = 'p'  factor = 1.0, 2.0")
        axes = SvgAxes(0.0, 0.0, 100.0, 100.0)
        draw_zones(axes, case)
        # 9 points, then 5 along another side.
        self.assertEqual(len(axes.cells.y), len(axes.cells.values) + 1)
        self.assertEqual(np.isnan(axes.cells.values).all(axis=1).nonzero()[0].tolist(), [9])
        self.assertEqual(axes.words["ylabel"], "s: floor, right")

    def test_an_obstacle_that_has_moved_is_drawn_where_it_is(self):
        case = self.solve(SUPPORT, PRESSURE, CONTACT)
        case.line.point_data["gap"] = case.line.point_data["gap"] + 0.5
        drawn, = surfaces(case, 1.0, WINDOW)
        np.testing.assert_allclose(drawn[:, 1], -0.5, atol=1e-12)

    def test_an_obstacle_whose_file_is_gone_is_drawn_at_the_contact_points(self):
        self.write("line.csv", "-1 0\n9 0\n")
        case = self.solve(SUPPORT, PRESSURE, "contact set = 'bottom'  obstacle = 'polyline'  line = 'line.csv'")
        self.assertEqual(len(surfaces(case, 1.0, WINDOW)[0]), 2)
        (self.directory / "line.csv").unlink()
        self.assertEqual(len(surfaces(case, 1.0, WINDOW)[0]), len(case.line.points))

    def test_texts_units_and_uniform_fields(self):
        case = self.solve("support set = 'left'  ux = 0.0", PRESSURE, "contact set = 'bottom'",
                          "case title = 'of $5 & <b>'  units = 'mm, N, MPa'")
        self.plot("block", "--format", "svg,pdf")
        words = text_of(self.directory / "block.svg")
        self.assertLessEqual({"of $5 &amp; &lt;b&gt;", "slip [mm]", "gap [mm]", "contact stress [MPa]", "x [mm]",
                              "von Mises stress [MPa], uniform", "length along the contact line [mm]"}, {*words})
        # Its one value is on the bar: plane strain under pressure alone.
        value = case.mesh.cell_data["von_mises"][0]
        self.assertIn(f"{value:.4g}", words)
        pdf = (self.directory / "block.pdf").read_bytes()
        self.assertIn(b"/CIDFontType2", pdf)
        self.assertNotIn(b"/Type3", pdf)

    def test_options(self):
        self.solve(*PUNCH, mesh="size = 4.0, 2.0  cells = 40, 8")
        run = self.plot("block", "--panels", "stress,slip", "--abscissa", "x", "--format", "png,svg", "--size=100x50")
        self.assertEqual(run.stdout, "block.png\nblock.svg\n")
        # 200 points per inch of 25.4 mm
        width, height = struct.unpack(">II", (self.directory / "block.png").read_bytes()[16:24])
        self.assertEqual((width, height), (787, 393))
        words = text_of(self.directory / "block.svg")
        self.assertLessEqual({"x", "slip", "contact stress"}, {*words})
        self.assertFalse({"y", "gap", "residual"} & {*words})
        self.plot("block", "--panels", "body", "--field", "nodal_stress_xy", "--scale", "30", "--format", "svg")
        words = text_of(self.directory / "block.svg")
        self.assertLessEqual({"nodal stress xy", "displacements and gaps × 30"}, {*words})
        self.plot("block", "--field", "displacement", "--scale", "0", "--format", "svg")

    def test_figures_in_python(self):
        from amontons import figure  # pylint: disable=import-outside-toplevel
        case = self.solve(SUPPORT, PRESSURE, CONTACT)
        drawn = figure(case, ["stress"], size=(80, 40))
        np.testing.assert_allclose(drawn.get_size_inches(), [80/25.4, 40/25.4])
        pressure, = [line for line in drawn.subfigs[0].axes[0].lines if line.get_label() == "pressure"]
        np.testing.assert_array_equal(pressure.get_ydata(), case.line.point_data["contact_pressure"])
        with self.assertRaisesRegex(ValueError, "nothing to show in the panels detail"):
            figure(case.path, ["detail"])

    def test_faults_are_sentences(self):
        self.solve(SUPPORT, PRESSURE, CONTACT)
        for arguments, sentence in {
                ("block", "--field", "mises"): "plot: block.vtu: no field 'mises'; the fields are: contact_pressure, ",
                ("block", "--scale", "-1"): "argument --scale: expected a number of at least 0, found '-1'; try --help",
                ("block", "--size", "10x10"): "argument --size: expected 20 to 2000 mm, found '10x10'",
                ("block", "--size", "wide"): "argument --size: expected WIDTHxHEIGHT in mm, found 'wide'",
                ("block", "--panels", "body,foo"): "argument --panels: 'foo' is none of body, detail, stress, slip, ",
                ("block", "--format", "gif"): "argument --format: 'gif' is none of png, svg, pdf",
                ("nowhere",): "plot: nowhere: no case found; expected a folder with *.summary.json, or a "}.items():
            run = self.plot(*arguments, status=1)
            self.assertIn(sentence, run.stderr)
            self.assertNotIn("Traceback", run.stderr)
        self.assertIn("--abscissa", self.plot("--help").stdout)
        grid = self.directory / "block.vtu"
        grid.write_bytes(grid.read_bytes()[:2000])
        self.assertEqual(self.plot("block", status=1).stderr, "plot: block.vtu: damaged, or not a grid of Amontons\n")
        grid.unlink()
        self.assertEqual(self.plot("block", status=1).stderr, "plot: block.vtu: No such file or directory\n")
        self.write("block.summary.json", "{")
        self.assertEqual(self.plot("block", status=1).stderr, "plot: block.summary.json: damaged: not JSON\n")

    def test_columns_of_sweeps(self):
        loads = "load name = 'push'  set = 'right'  traction = -1.0, 0.2"
        self.solve(SUPPORT, PRESSURE, CONTACT, loads, "sweep load = 'push'  factor = 0.5, 1.0, 1.5")
        self.plot("block", "--field", "normal_force", "--format", "svg")
        self.assertLessEqual({"normal force", "factor of push"}, {*text_of(self.directory / "block.svg")})
        run = self.plot("block", "--field", "peak", status=1)
        self.assertIn("no column 'peak'; the columns are: case, ", run.stderr)
        self.assertIn("scale is not for a sweep", self.plot("block", "--scale", "2", status=1).stderr)


if __name__ == "__main__":
    unittest.main()
