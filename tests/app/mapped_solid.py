"""Structured meshes of solids with six sides: cells of the unit cube, mapped and written in Gmsh's format 2.2."""
from itertools import permutations, product

# Numbers of the elements in the format, and of their faces.
GMSH_KIND = {"tet4": (4, 2), "tet10": (11, 9), "hex8": (5, 3), "hex20": (17, 16)}
SIDES = ("left", "right", "front", "back", "bottom", "top")
HEX_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
# Edges in the format's order of the middle nodes, of the body and of its faces.
HEX_EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))
TET_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))


def mapped_solid(cells, element, mapping=lambda r, s, t: (r, s, t), set_of=lambda side, place: side, is_ring=False):
    """The text of a mesh file: cells[0] by cells[1] by cells[2] cells, the point (r, s, t) of the unit cube put to
    mapping(r, s, t).

    The boundary sets are left (r = 0), right, front (s = 0), back, bottom (t = 0), top; `set_of` may give a face
    another name by its middle (r, s, t). The region is body. Tetrahedra are six to a cell, about its diagonal. A ring
    closes upon itself along s: it has neither front nor back.
    """
    order = 2 if element in ("tet10", "hex20") else 1
    number, rows, names = {}, [], {}

    def node(index):
        if is_ring:
            index = (index[0], index[1] % (order*cells[1]), index[2])
        return number.setdefault(index, len(number) + 1)

    def nodes(corners, edges):
        middles = [tuple((p + q)//2 for p, q in zip(corners[a], corners[b])) for a, b in edges]
        return [node(index) for index in (*corners, *(middles if order == 2 else ()))]

    for cell in product(*map(range, cells)):
        corners = [tuple(order*(c + step) for c, step in zip(cell, corner)) for corner in HEX_CORNERS]
        if element.startswith("hex"):
            rows.append((GMSH_KIND[element][0], 0, nodes(corners, HEX_EDGES)))
            continue
        for path in permutations(range(3)):
            tet = [corners[0]]
            for axis in path:
                tet.append(tuple(c + order*(a == axis) for a, c in enumerate(tet[-1])))
            if path not in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
                tet[1], tet[2] = tet[2], tet[1]
            rows.append((GMSH_KIND[element][0], 0, nodes(tet, TET_EDGES)))
    for side, name in enumerate(SIDES):
        axis, end = divmod(side, 2)
        if is_ring and axis == 1:
            continue
        for across in product(*(range(n) for other, n in enumerate(cells) if other != axis)):
            quad = []
            for step in ((0, 0), (1, 0), (1, 1), (0, 1)):
                index = [order*(c + s) for c, s in zip(across, step)]
                quad.append(tuple(index[:axis] + [order*end*cells[axis]] + index[axis:]))
            middle = tuple(sum(index[a] for index in quad)/(4*order*cells[a]) for a in range(3))
            group = names.setdefault(set_of(name, middle), len(names) + 1)
            # The diagonal of the tetrahedra goes from the first corner to the third.
            for face in ([quad] if element.startswith("hex") else [quad[:3], [quad[0], *quad[2:]]]):
                edges = [(k, (k + 1) % len(face)) for k in range(len(face))]
                rows.append((GMSH_KIND[element][1], group, nodes(face, edges)))
    body = len(names) + 1
    places = ["{} {!r} {!r} {!r}".format(node, *map(float, mapping(*(i/(order*n) for i, n in zip(index, cells)))))
              for index, node in number.items()]
    elements = [" ".join(map(str, (row, kind, 2, group or body, group or body, *members)))
                for row, (kind, group, members) in enumerate(rows, start=1)]
    groups = [f'2 {group} "{name}"' for name, group in names.items()] + [f'3 {body} "body"']
    return "\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat",
                      "$PhysicalNames", str(len(groups)), *groups, "$EndPhysicalNames",
                      "$Nodes", str(len(places)), *places, "$EndNodes",
                      "$Elements", str(len(elements)), *elements, "$EndElements", ""])
