"""A ring that hangs on a pin: mesh and decks."""
import math


def ring(wave, radii=(1.0, 1.5, 2.0), sides=48):
    """A Gmsh file of a ring whose cells around are of unequal length if `wave` is not 0, with sets hole and rim."""
    angles = [2*math.pi*k/sides + wave*math.sin(5*k) for k in range(sides)]
    nodes = [(radius*math.cos(angle), radius*math.sin(angle)) for radius in radii for angle in angles]
    cells = []
    for k in range(sides):
        near = (k + 1) % sides
        cells.append(f"1 2 1 1 {k + 1} {near + 1}")
        cells.append(f"1 2 3 3 {2*sides + 1 + near} {2*sides + 1 + k}")
        cells += [f"3 2 2 2 {first + k} {first + sides + k} {first + sides + near} {first + near}"
                  for first in (1, sides + 1)]
    return "\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3", '1 1 "hole"', '2 2 "ring"',
                      '1 3 "rim"', "$EndPhysicalNames", "$Nodes", str(3*sides),
                      *(f"{i} {x!r} {y!r} 0" for i, (x, y) in enumerate(nodes, 1)), "$EndNodes",
                      "$Elements", str(4*sides), *(f"{i} {cell}" for i, cell in enumerate(cells, 1)),
                      "$EndElements", ""])


def hung_ring(wave, angle, friction, force, clearance=0.001):
    """A deck of the ring on a round pin, with a point load on its rim where the mesh has a node."""
    turned = 2*math.pi*angle/48 + wave*math.sin(5*angle)
    return (f"&mesh file = 'ring.msh' /\n&material young = 1e3  poisson = 0.3 /\n"
            f"&load name = 'weight'  point = {2*math.cos(turned)!r}, {2*math.sin(turned)!r}"
            f"  force = {force[0]!r}, {force[1]!r} /\n"
            f"&contact set = 'hole'  friction = {friction}  obstacle = 'circle'  point = 0.0, {1.0 - clearance!r}"
            f"  radius = {1.0 - clearance!r} /\n")


def ring_on_elastic_pin(slave, angle, friction, clearance=0.001):
    """A deck of the ring, ring.msh, on a pin of the same material, pin.msh, with a weight on its rim; `slave`: the
    surface with the multipliers, that of the 'ring' or that of the 'pin'."""
    sets = ("ring.hole", "pin.rim") if slave == "ring" else ("pin.rim", "ring.hole")
    turned = 2*math.pi*angle/48
    return (f"&mesh name = 'ring'  file = 'ring.msh' /\n"
            f"&mesh name = 'pin'  file = 'pin.msh'  origin = 0.0, {-clearance!r} /\n"
            f"&material young = 1e3  poisson = 0.3 /\n&support set = 'pin.hole'  ux = 0.0  uy = 0.0 /\n"
            f"&load name = 'weight'  point = {2*math.cos(turned)!r}, {2*math.sin(turned)!r}  force = 0.0, -1e-2 /\n"
            f"&contact set = '{sets[0]}'  against = '{sets[1]}'  friction = {friction} /\n")
