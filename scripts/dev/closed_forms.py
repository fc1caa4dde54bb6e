"""Closed forms for the error bars: bodies on meshes of any fineness, and the true values of their key results.

K. L. Johnson, *Contact Mechanics*, has the closed forms, but for the tube's and the spinning disc's (Timoshenko and
Goodier, articles 28 and 32), the rounded punch's, which integrates the slope of its profile (section 5.3), and the
receding layer's, an integral equation. Blocks are wide enough for their far sides to matter less than the bars.
"""
import math
import subprocess
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[2]/"tests"/room) for room in ("verification", "app")]
from graded_block import between, graded_block, stations  # noqa: E402
from mapped_mesh import mapped_mesh, sector  # noqa: E402
from receding_layer import Layer  # noqa: E402

YOUNG, POISSON = 1000.0, 0.3
MODULUS = YOUNG/(1 - POISSON**2)
ELEMENTS = ("tri3", "quad4", "tri6", "quad8", "quad9")
QUADRATIC = ELEMENTS[2:]


class Problem:
    """A body, its mesh aside, with the true values of key results."""
    elements = ELEMENTS
    density = 0.0
    youngs = {"": YOUNG}  # of each region, '' for all

    def __init__(self, groups, exact, cells, hypothesis="plane strain"):
        self.groups = groups
        self.exact = exact
        self.cells = cells  # along the width
        self.hypothesis = hypothesis
        self.line = ""  # points of a polyline

    def materials(self):
        """The &material groups."""
        return [f"material young = {young}  poisson = {POISSON}  density = {self.density}  "
                f"hypothesis = '{self.hypothesis}'" + f"  region = '{region}'"*(region != "")
                for region, young in self.youngs.items()]

    def meshes(self, element, n, folder, unstructured):
        """The &mesh groups of a mesh with n cells along the width, whose files are put into a folder."""
        raise NotImplementedError


class Rectangle(Problem):
    """A rectangle on a rigid obstacle."""

    def __init__(self, size, groups, exact, cells, line="", origin=0.0, hypothesis="plane strain"):
        super().__init__(groups, exact, cells, hypothesis)
        self.size = size
        self.line = line
        self.origin = origin

    def meshes(self, element, n, folder, unstructured):
        return [self.unstructured(element, n, folder) if unstructured else self.regular(element, n)]

    def regular(self, element, n):
        """The &mesh of a regular mesh."""
        rows = max(1, round(n*self.size[1]/self.size[0]))
        diagonal = "alternating" if n % 2 else "right"
        return f"size = {self.size[0]}, {self.size[1]}  cells = {n}, {rows}  element = '{element}'  " \
            f"diagonal = '{diagonal}'  origin = {self.origin}, 0.0"

    def unstructured(self, element, n, folder):
        """The &mesh of one that Gmsh makes of the same number of elements along the width."""
        width, height = self.size
        corners = ((0, 0), (width, 0), (width, height), (0, height))
        lines = [f"Point({i}) = {{{self.origin + x}, {y}, 0, {width/n}}};" for i, (x, y) in enumerate(corners, 1)]
        for i, name in enumerate(("bottom", "right", "top", "left"), 1):
            lines += [f"Line({i}) = {{{i}, {i % 4 + 1}}};", f'Physical Curve("{name}") = {{{i}}};']
        lines += ["Curve Loop(1) = {1:4};", "Plane Surface(1) = {1};", 'Physical Surface("body") = {1};',
                  f"Mesh.ElementOrder = {1 if element in ('tri3', 'quad4') else 2};",
                  f"Mesh.SecondOrderIncomplete = {int(element == 'quad8')};", f"Mesh.RandomSeed = {n};"]
        if element.startswith("quad"):
            lines += ["Recombine Surface {1};", "Mesh.RecombinationAlgorithm = 3;"]
        Path(folder, "mesh.geo").write_text("\n".join(lines) + "\n", encoding="utf-8")
        subprocess.run(["gmsh", "-2", "-format", "msh41", "mesh.geo"], cwd=folder, check=True, capture_output=True)
        return "kind = 'file'  file = 'mesh.msh'"


class Mapped(Problem):
    """Bodies on meshes of cells put to places of their own, so that nodes are where chance has them."""

    def __init__(self, make, groups, exact, cells, elements=QUADRATIC, hypothesis="plane strain"):
        super().__init__(groups, exact, cells, hypothesis)
        self.make = make  # text of each mesh by its name, from element and n
        self.elements = elements

    def meshes(self, element, n, folder, unstructured):
        texts = self.make(element, n)
        for name, text in texts.items():
            Path(folder, f"{name}.msh").write_text(text, encoding="utf-8")
        return [f"kind = 'file'  file = '{name}.msh'" + f"  name = '{name}'"*(len(texts) > 1) for name in texts]


def wave_values(share, modulus):
    """What presses bodies on a wave of the length 2 and the amplitude 0.01; width and peak (section 13.2)."""
    full = 0.005*math.pi*modulus
    if share >= 1:
        return share*full, {"contact_width": 1.0, "max_contact_pressure": (share + 1)*full}
    sine = math.sqrt(share)
    return share*full, {"contact_width": 2/math.pi*math.asin(sine), "max_contact_pressure": 2*share*full/sine}


def wave(share):
    """A block on a rigid wave, under a multiple of the pressure that closes all gaps."""
    pressure, exact = wave_values(share, MODULUS)
    if share >= 1:
        # What the wave and the mean pressure store; the sides are held.
        stiff = YOUNG*(1 - POISSON)/((1 + POISSON)*(1 - 2*POISSON))
        exact["strain_energy"] = 0.01*0.005*math.pi*MODULUS/4 + 4*pressure**2/(2*stiff)
    line = "".join(f"{x!r}, {0.01*(math.cos(math.pi*x) - 1)!r}\n" for x in (i/1000 - 2 for i in range(4001)))
    return Rectangle((1.0, 4.0), ("support set = 'left'  ux = 0.0", "support set = 'right'  ux = 0.0",
                     f"load set = 'top'  pressure = {pressure}", "contact set = 'bottom'  obstacle = 'polyline'"),
                     exact, (5, 6, 7, 8, 9, 10, 11), line)


def wave_pair(share):
    """Two equal blocks, the lower one with a wave for its upper side."""
    def make(element, n):
        return {"upper": mapped_mesh((n, 3*n), element, lambda s, t: (s, 4*t)),
                "lower": mapped_mesh((n + 1, 3*n), element, lambda s, t: (
                    s, 4*(t - 1) + 0.01*t*(math.cos(math.pi*s) - 1)))}

    pressure, exact = wave_values(share, MODULUS/2)
    sides = tuple(f"support set = '{body}.{side}'  ux = 0.0"
                  for body in ("upper", "lower") for side in ("left", "right"))
    return Mapped(make, (*sides, "support set = 'lower.bottom'  uy = 0.0",
                  f"load set = 'upper.top'  pressure = {pressure}",
                  "contact set = 'upper.bottom'  against = 'lower.top'"), exact, (5, 6, 7, 9))


def half_block(force, profile, exact, line="", cells=(11, 13, 16, 19, 20)):
    """Half of a block on a symmetric obstacle that makes a contact of the half width 1."""
    return Rectangle((12.0, 24.0), ("support set = 'left'  ux = 0.0", f"load set = 'top'  pressure = {force/24.0}",
                   f"contact set = 'bottom'  {profile}"), exact, cells, line)


def cylinder():
    """Half of a block on a cylinder of the radius 100 (section 4.2)."""
    force = math.pi*MODULUS/400
    return half_block(force, "obstacle = 'circle'  radius = 100.0",
                      {"contact_width": 1.0, "max_contact_pressure": 2*force/math.pi})


def whole_cylinder():
    """A whole block on the same cylinder, the middle of the contact anywhere in a cell."""
    def make(element, n):
        shift = 24/n*(0.618*n % 1)
        return {"block": mapped_mesh((n, n), element, lambda s, t: (
            24*(s - 0.5) + shift*math.sin(math.pi*s), 24*t))}

    force = math.pi*MODULUS/400
    return Mapped(make, ("support point = -12.0, 24.0  ux = 0.0", f"load set = 'top'  pressure = {force/24.0}",
                  "contact set = 'bottom'  obstacle = 'circle'  radius = 100.0"),
                  {"contact_width": 2.0, "max_contact_pressure": 2*force/math.pi}, (25, 28, 31, 36, 41, 44), ELEMENTS)


def wedge():
    """A blunt wedge (section 5.2); the pressure has no largest value."""
    return half_block(0.01*MODULUS, "obstacle = 'polyline'", {"contact_width": 1.0},
                      "-50.0, -0.5\n0.0, 0.0\n50.0, -0.5\n")


def rounded_punch():
    """A flat punch of the half width 1/2, rounded to parabolas of the radius 50 (M. Ciavarella, D. A. Hills, G. Monno,
    Proc. Inst. Mech. Eng. C 212, 1998, has the pressure at x = sin(place))."""
    radius, flat = 50.0, 0.5
    angle = math.asin(flat)
    force = MODULUS/radius*(0.5*(math.pi/2 - angle) + 0.25*math.sin(2*angle) - flat*math.cos(angle))

    def pressure(place):
        plus, minus = place + angle, place - angle
        edge = math.sin(place)*math.log(abs(math.sin(plus)/math.sin(minus))) \
            + flat*math.log(abs(math.tan(plus/2)*math.tan(minus/2)))
        return 2*force/math.pi*((math.pi - 2*angle)*math.cos(place) + edge)/(math.pi - 2*angle - math.sin(2*angle))

    # Odd steps, none of which is where the curvature begins and the logarithms cancel.
    peak = max(pressure(math.pi/2*(i + 0.5)/20001) for i in range(20001))
    places = (-30, -20, -12, -8, *(i*0.002 - 5 for i in range(5001)), 8, 12, 20, 30)
    return half_block(force, "obstacle = 'polyline'", {"contact_width": 1.0, "max_contact_pressure": peak},
                      "".join(f"{x!r}, {-max(0.0, abs(x) - flat)**2/(2*radius)!r}\n" for x in places))


def revolved(force, profile, exact, line=""):
    """A cylinder on an obstacle of revolution that makes a contact of the radius 1."""
    return Rectangle((10.0, 10.0), ("support set = 'left'  ux = 0.0",
                   f"load set = 'top'  pressure = {force/(100*math.pi)}", f"contact set = 'bottom'  {profile}"), exact,
                   (11, 13, 16, 19, 20, 23, 27), line, hypothesis="axisymmetric")


def sphere():
    """A sphere of the radius 100 (section 3.4)."""
    force = 4*MODULUS/300
    return revolved(force, "obstacle = 'parabola'  radius = 100.0",
                    {"contact_width": 1.0, "max_contact_pressure": 1.5*force/math.pi})


def cone():
    """A blunt cone (section 5.2); the pressure has no largest value."""
    return revolved(0.005*math.pi*MODULUS, "obstacle = 'polyline'", {"contact_width": 1.0},
                    "-20.0, -0.2\n0.0, 0.0\n20.0, -0.2\n")


def tube():
    """A thick tube on a rigid shaft that is too large for it."""
    inner, outer, excess = 1.0, 3.0, 0.001
    ratio = (outer**2 + inner**2)/(outer**2 - inner**2)
    pressure = excess*YOUNG/(inner*(ratio + POISSON))
    return Rectangle((outer - inner, 0.5), (
        "support set = 'bottom'  uy = 0.0",
        f"contact set = 'left'  normal = 1.0, 0.0  point = {inner}, 0.0  extra_gap = {-excess}"),
                     {"max_contact_pressure": pressure, "max_von_mises": pressure*math.sqrt(1 + ratio + ratio**2)},
                     (4, 5, 7, 8, 10, 13), "", inner, "axisymmetric")


def spinning(inner, outer, modulus, poisson):
    """Von Mises stress at the bore, largest displacement, and twice the integral of r^2 u over r, of a disc of the
    density 0.5 at 10 rad per unit of time."""
    factor = (3 + poisson)*50/8

    def moved(r):
        radial = factor*(inner**2 + outer**2 - (inner*outer/r)**2 - r**2)
        hoop = factor*(inner**2 + outer**2 + (inner*outer/r)**2 - (1 + 3*poisson)/(3 + poisson)*r**2)
        return hoop, r*(hoop - poisson*radial)/modulus

    places = [inner + (outer - inner)*i/2000 for i in range(2001)]
    values = [r*r*moved(r)[1] for r in places]
    return moved(inner)[0], max(moved(r)[1] for r in places), 2*(outer - inner)/6000*(
        values[0] + 4*sum(values[1:-1:2]) + 2*sum(values[2:-1:2]) + values[-1])


def disc():
    """A quarter of a spinning disc with a hole. Refined meshes keep the sides of the first one: it must be fine along
    the circles."""
    hoop, moved, work = spinning(1.0, 2.0, YOUNG, POISSON)
    problem = Mapped(lambda element, n: {"disc": mapped_mesh((n, 6*n), element, sector(1.0, 2.0, math.pi/2))},
                     ("support set = 'bottom'  uy = 0.0", "support set = 'top'  ux = 0.0", "load angular_speed = 10.0"),
                     {"max_von_mises": hoop, "max_displacement": moved, "strain_energy": work*50*math.pi/8},
                     (2, 3, 4, 5), hypothesis="plane stress")
    problem.density = 0.5
    return problem


def spinning_tube():
    """A spinning tube between two planes."""
    ratio = POISSON/(1 - POISSON)
    hoop, moved, work = spinning(1.0, 2.0, MODULUS, ratio)
    problem = Rectangle((1.0, 0.5), ("support set = 'bottom'  uy = 0.0", "support set = 'top'  uy = 0.0",
                        "load angular_speed = 10.0"), {
                            "max_von_mises": hoop*math.sqrt(1 - POISSON + POISSON**2),
                            "max_displacement": moved, "strain_energy": work*50*math.pi/4},
                        (3, 4, 5, 7, 9), "", 1.0, "axisymmetric")
    problem.density = 0.5
    return problem


def receding(ratio, elements):
    """Half of a layer of the height 1, pressed on |x| < 1, that lies on a half plane whose compliance is `ratio` times
    its own; on a rigid one for 0."""
    def make(element, n):
        across = stations(3.0, 12.0, 1/n)
        meshes = {"layer": mapped_mesh((len(across) - 1, n), element, lambda s, t: (between(across, s), t), n)}
        if ratio > 0:
            wide, deep = stations(3.0, 200.0, 1.125/n), stations(1.0, 200.0, 1.125/n)
            meshes["plane"] = mapped_mesh((len(wide) - 1, len(deep) - 1), element, lambda s, t: (
                between(wide, s), -between(deep, 1 - t)))
        return meshes

    width, peak, _ = Layer(1.0, ratio).solve()
    exact = {"contact_width": width, "max_contact_pressure": peak}
    if ratio > 0:
        groups = ("support set = 'layer.left'  ux = 0.0", "support set = 'plane.left'  ux = 0.0",
                  "support set = 'plane.bottom'  ux = 0.0  uy = 0.0", "load set = 'layer.pressed'  pressure = 1.0",
                  "contact set = 'layer.bottom'  against = 'plane.top'")
    else:
        groups = ("support set = 'left'  ux = 0.0", "load set = 'pressed'  pressure = 1.0", "contact set = 'bottom'")
    problem = Mapped(make, groups, exact, (3, 4, 5, 6, 7), elements)
    if ratio > 0:
        problem.youngs = {"layer": YOUNG, "plane": YOUNG/ratio}
    return problem


def partial_slip():
    """Two equal blocks, the lower one with a crest of the radius 100, pressed and then pushed (section 7.2).

    The forces that their grip takes, P = 3.18196 and Q = 0.90003, are those on meshes of quad9, extrapolated.
    """
    def make(element, n):
        return {"upper": graded_block(element, 1/n, 40.0, 1.5, is_mirrored=True),
                "lower": graded_block(element, 1.125/n, 40.0, 1.125*1.5, is_mirrored=True,
                                      shape=lambda x: x**2/200)}

    press, push, friction = 3.18196, 0.90003, 0.5
    half = math.sqrt(8*press*100/(math.pi*MODULUS))
    stick = half*math.sqrt(1 - push/(friction*press))
    peak = 2*press/(math.pi*half)
    grip = tuple(f"support set = 'lower.{side}'  ux = 0.0  uy = 0.0" for side in ("bottom", "left", "right")) \
        + tuple(f"support set = 'upper.{side}'  ux = 0.005  uy = -0.0165" for side in ("top", "left", "right"))
    contact = f"contact set = 'upper.bottom'  against = 'lower.top'  friction = {friction}  search = 2.0"
    return Mapped(make, (*grip, contact),
                  {"contact_width": 2*half, "stick_width": 2*stick, "max_contact_pressure": peak,
                   "max_contact_shear": friction*peak*math.sqrt(1 - (stick/half)**2)}, (4, 5, 6, 7))


def quartic():
    """Half of a block on the crest x^4/400; the pressure is largest at x = 1/sqrt(2) (section 5.3)."""
    height = 1/400
    places = (-30, -20, -12, -8, *(i*0.002 - 5 for i in range(5001)), 8, 12, 20, 30)
    return half_block(1.5*math.pi*MODULUS*height/2, "obstacle = 'polyline'",
                      {"contact_width": 1.0, "max_contact_pressure": math.sqrt(2)*MODULUS*height},
                      "".join(f"{x!r}, {-height*x**4!r}\n" for x in places))


def tilted_punch():
    """A block on a flat punch of the half width 1 that is tilted by 1/1000 and touches with all of its width
    (section 2.8)."""
    force, tilt = 0.01*MODULUS, 0.001
    return Rectangle((24.0, 24.0), ("support set = 'left'  ux = 0.0", "support set = 'right'  ux = 0.0",
                     f"load set = 'top'  pressure = {force/24.0}", "contact set = 'bottom'  obstacle = 'polyline'"),
                     {"contact_width": 2.0, "contact_centroid_x": math.pi*MODULUS*tilt/(4*force)},
                     (23, 31, 36, 43, 48), f"-1.001, -9.0\n-1.0, {-tilt}\n1.0, {tilt}\n1.001, -9.0\n", -12.0)


def ring():
    """A quarter of a tube under internal pressure."""
    inner, outer = 1.0, 2.0
    ratio = (outer**2 + inner**2)/(outer**2 - inner**2)
    axial = POISSON*(ratio - 1)
    vectors = (-1 - ratio, ratio - axial, axial + 1)
    moved = (1 + POISSON)/YOUNG/(outer**2 - inner**2)*((1 - 2*POISSON)*inner**2 + outer**2)
    return Mapped(lambda element, n: {"ring": mapped_mesh((n, 5*n), element, sector(inner, outer, math.pi/2))},
                  ("support set = 'bottom'  uy = 0.0", "support set = 'top'  ux = 0.0",
                   "load set = 'left'  pressure = 1.0"),
                  {"max_von_mises": math.sqrt(0.5*sum(x*x for x in vectors)), "max_displacement": moved,
                   "strain_energy": math.pi/4*moved}, (2, 3, 4, 5))


def hole():
    """A quarter of a plate with a small hole under tension (Kirsch)."""
    def move(s, t):
        angle = math.pi/2*(1 - s)
        far = 60/max(math.cos(angle), math.sin(angle))
        radius = 1 + (far - 1)*(60.0**t - 1)/59
        return radius*math.cos(angle), radius*math.sin(angle)

    return Mapped(lambda element, n: {"plate": mapped_mesh((2*n, 2*n + 1), element, move, n)},
                  ("support set = 'right'  uy = 0.0", "support set = 'left'  ux = 0.0",
                   "load set = 'pressed'  traction = 0.0, 1.0"), {"max_von_mises": 3.0}, (2, 3, 4, 5),
                  hypothesis="plane stress")


def bending():
    """A beam in pure bending."""
    half, length = 0.5, 3.0
    return Rectangle((length, 2*half), (
        "support set = 'left'  ux = 0.0", "support point = 0.0, 0.0  uy = 0.0",
        f"load set = 'right'  traction = {-half}, 0.0  traction_slope = 0.0, 0.0, 1.0, 0.0"),
                     {"max_displacement": math.hypot(half*length, 0.5*length**2)/YOUNG, "max_von_mises": half,
                      "strain_energy": half**3*length/(3*YOUNG)}, (6, 8, 10, 14, 18), hypothesis="plane stress")


def rings():
    """A quarter of a tube shrunk on another one (Timoshenko and Goodier, article 28)."""
    inner, middle, outer, excess = 1.0, 1.5, 2.5, 0.001
    compliance = sum((b**2 + a**2)/(b**2 - a**2) for a, b in ((inner, middle), (middle, outer)))
    pressure = excess*YOUNG/(middle*compliance)

    def make(element, n):
        return {"shaft": mapped_mesh((n, 5*n), element, sector(inner, middle, math.pi/2)),
                "hub": mapped_mesh((n, 4*n + 1), element, sector(middle, outer, math.pi/2))}

    sides = tuple(f"support set = '{body}.{side} = 0.0" for body in ("shaft", "hub")
                  for side in ("bottom'  uy", "top'  ux"))
    return Mapped(make, (*sides, f"contact set = 'shaft.right'  against = 'hub.left'  extra_gap = {-excess}"),
                  {"max_contact_pressure": pressure}, (2, 3, 4, 5),
                  hypothesis="plane stress")


PROBLEMS = {"wave_08": wave(0.08), "wave_20": wave(0.2), "wave_45": wave(0.45), "wave_80": wave(0.8),
            "wave_150": wave(1.5), "wave_pair_30": wave_pair(0.3), "wave_pair_150": wave_pair(1.5),
            "cylinder": cylinder(), "whole_cylinder": whole_cylinder(), "wedge": wedge(),
            "rounded_punch": rounded_punch(), "sphere": sphere(), "cone": cone(), "tube": tube(), "disc": disc(),
            "spinning_tube": spinning_tube(), "receding_rigid": receding(0.0, ELEMENTS),
            "receding_equal": receding(1.0, ELEMENTS), "receding_soft": receding(4.0, ELEMENTS),
            "partial_slip": partial_slip(), "quartic": quartic(), "tilted_punch": tilted_punch(), "ring": ring(),
            "hole": hole(), "bending": bending(), "rings": rings()}
