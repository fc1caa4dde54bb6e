#!/usr/bin/env python3
"""Draws the rooms of src/ and which uses which, from the `use` statements. Usage: module_graph.py >SVG

A room stands above those that it uses; an arrow that follows from others is left out. Standard library only.
"""
import sys

from check_layers import APP, FACADE, MAY_USE, SOURCE, USE, module_name, room_of

WIDTH, HEIGHT, GAP_X, GAP_Y, MARGIN = 150, 40, 24, 46, 12


def uses_of_rooms():
    """For each room, the rooms that its modules really use, `base` aside, and the number of its modules."""
    files = [path for path in SOURCE.rglob("*") if path.name.endswith((".f90", ".f90.in")) and room_of(path) != FACADE]
    room = {module_name(path): room_of(path) for path in files}
    uses = {name: set() for name in (*MAY_USE, APP)}
    for path in files:
        for match in map(USE.match, path.read_text(encoding="utf-8").splitlines()):
            used = room.get(match[2].lower()) if match else None
            if used not in (None, "base", room_of(path)):
                uses[room_of(path)].add(used)
    counts = {name: sum(value == name for value in room.values()) for name in uses}
    del uses["base"]
    return uses, counts


def reachable(uses, start):
    """The rooms that a room uses, directly or through others."""
    found, open_rooms = set(), list(uses[start])
    while open_rooms:
        name = open_rooms.pop()
        if name not in found:
            found.add(name)
            open_rooms.extend(uses[name])
    return found


def reduced(uses):
    """The uses without those that follow from others."""
    return {name: {used for used in direct if not any(used in reachable(uses, other) for other in direct - {used})}
            for name, direct in uses.items()}


def levels_of(uses):
    """The rooms by their height above the lowest."""
    height = {}

    def height_of(name):
        if name not in height:
            height[name] = 1 + max((height_of(used) for used in uses[name]), default=-1)
        return height[name]

    levels = [[] for _ in range(1 + max(map(height_of, uses)))]
    for name in uses:
        levels[height[name]].append(name)
    return levels


def drawing(uses, counts):
    """The picture as SVG."""
    levels = levels_of(uses)
    width = max(map(len, levels)) * (WIDTH + GAP_X) - GAP_X + 2*MARGIN
    height = len(levels) * (HEIGHT + GAP_Y) - GAP_Y + 2*MARGIN
    place = {}
    for i, level in enumerate(levels):
        left = (width - len(level)*(WIDTH + GAP_X) + GAP_X)/2
        for k, name in enumerate(level):
            place[name] = (left + k*(WIDTH + GAP_X), height - MARGIN - HEIGHT - i*(HEIGHT + GAP_Y))
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
             f'height="{height}" font-family="sans-serif" font-size="13">',
             f'<rect width="{width}" height="{height}" fill="#fff"/>',
             '<defs><marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" '
             'orient="auto"><path d="M0 0L8 4L0 8z" fill="#557"/></marker></defs>']
    for name, direct in reduced(uses).items():
        x, y = place[name]
        for used in sorted(direct):
            to_x, to_y = place[used]
            parts.append(f'<path d="M{x + WIDTH/2} {y + HEIGHT}C{x + WIDTH/2} {y + HEIGHT + GAP_Y/2} '
                         f'{to_x + WIDTH/2} {to_y - GAP_Y/2} {to_x + WIDTH/2} {to_y - 2}" fill="none" stroke="#557" '
                         'stroke-width="1.2" marker-end="url(#tip)"/>')
    for name, (x, y) in place.items():
        parts.append(f'<rect x="{x}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="6" fill="#eef2f8" stroke="#557"/>')
        parts.append(f'<text x="{x + WIDTH/2}" y="{y + 17}" text-anchor="middle" font-weight="bold">{name}</text>')
        parts.append(f'<text x="{x + WIDTH/2}" y="{y + 33}" text-anchor="middle" fill="#445">{counts[name]} '
                     'modules</text>')
    return "\n".join([*parts, "</svg>", ""])


if __name__ == "__main__":
    sys.stdout.write(drawing(*uses_of_rooms()))
