"""Meshes of blocks whose boundary sets may end anywhere along a side."""


def block_mesh(sets, size=(4.0, 3.0), cells=(40, 8), corner=(0.0, 0.0), bottom=lambda x: 0.0, is_quadratic=False):
    """The text of a Gmsh mesh of quadrilaterals: a block whose bottom is raised by a function of x.

    Each set has a name, a side (bottom, right, top, left), and where it begins and ends along x or y."""
    step = 2 if is_quadratic else 1
    columns, rows = (step*n for n in cells)
    number, nodes = {}, []
    for j in range(rows + 1):
        for i in range(columns + 1):
            if not (is_quadratic and i % 2 and j % 2):
                number[i, j] = len(nodes) + 1
                x = corner[0] + size[0]*i/columns
                low = corner[1] + bottom(x)
                nodes.append((x, low + (corner[1] + size[1] - low)*j/rows))
    elements = []
    for tag, (side, begin, end) in enumerate(sets.values(), 1):
        for k in range(cells[0] if side in ("bottom", "top") else cells[1]):
            places = [{"bottom": (i, 0), "top": (i, rows), "left": (0, i), "right": (columns, i)}[side]
                      for i in (step*k, step*(k + 1), step*k + 1)]
            side_nodes = [number[place] for place in places[:step + 1]]
            middle = sum(nodes[node - 1][side in ("left", "right")] for node in side_nodes[:2])/2
            if begin <= middle <= end:
                elements.append((8 if is_quadratic else 1, tag, side_nodes))
    for j in range(0, rows, step):
        for i in range(0, columns, step):
            places = [(i, j), (i + step, j), (i + step, j + step), (i, j + step)]
            if is_quadratic:
                places += [(i + 1, j), (i + 2, j + 1), (i + 1, j + 2), (i, j + 1)]
            elements.append((16 if is_quadratic else 3, len(sets) + 1, [number[place] for place in places]))
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", len(sets) + 1,
             *(f'1 {tag} "{name}"' for tag, name in enumerate(sets, 1)), f'2 {len(sets) + 1} "body"',
             "$EndPhysicalNames", "$Nodes", len(nodes),
             *(f"{k} {x!r} {y!r} 0" for k, (x, y) in enumerate(nodes, 1)), "$EndNodes", "$Elements", len(elements),
             *(f"{k} {kind} 2 {tag} {tag} " + " ".join(map(str, places))
               for k, (kind, tag, places) in enumerate(elements, 1)), "$EndElements", ""]
    return "\n".join(map(str, lines))
