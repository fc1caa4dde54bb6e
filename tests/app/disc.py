"""A disc as a mesh file: a ball for every obstacle."""
from math import cos, pi, sin


def disc_mesh(around=48, rings=8, radius=1.0):
    """A disc about the origin in Gmsh's format 2.2, its whole boundary the set rim, the half below the set lower."""
    def at(ring, k):
        return 2 + (ring - 1)*around + k % around

    nodes = [(0.0, 0.0)] + [(radius*ring/rings*cos(2*pi*k/around), radius*ring/rings*sin(2*pi*k/around))
                            for ring in range(1, rings + 1) for k in range(around)]
    rim = [(at(rings, k), at(rings, k + 1)) for k in range(around)]
    elements = [(1, 1, *side) for side in rim] + [(1, 2, *side) for side in rim[around//2:]]
    elements += [(2, 3, 1, at(1, k), at(1, k + 1)) for k in range(around)]
    elements += [(3, 3, at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1))
                 for ring in range(1, rings) for k in range(around)]
    return "\n".join([
        "$MeshFormat", "2.2 0 8", "$EndMeshFormat",
        "$PhysicalNames", "3", '1 1 "rim"', '1 2 "lower"', '2 3 "ball"', "$EndPhysicalNames",
        "$Nodes", str(len(nodes)), *(f"{i} {x!r} {y!r} 0" for i, (x, y) in enumerate(nodes, start=1)), "$EndNodes",
        "$Elements", str(len(elements)),
        *(" ".join(map(str, (i, kind, 2, group, group, *members)))
          for i, (kind, group, *members) in enumerate(elements, start=1)), "$EndElements", ""])
