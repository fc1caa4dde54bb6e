#!/usr/bin/env python3
"""Prints the project file of FORD: the file ford.md, and behind it the rooms of src/ with their modules, each with the
first sentence of its comment. Usage: ford_page.py >build/ford.md

What a room holds is said in doc/architecture.md. Standard library only.
"""
import re

from check_layers import APP, FACADE, MAY_USE, ROOT, SOURCE, module_name, room_of


def held_in_rooms():
    """What each room holds, from the table of doc/architecture.md."""
    text = (ROOT/"doc/architecture.md").read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `([a-z/]+)` \| (.*) \|$", text, re.MULTILINE))


def first_sentence(path):
    """The first sentence of the comment above a module."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comment = []
    for line in lines:
        if not line.startswith("!>") or line == "!>":
            break
        comment.append(line[2:].strip())
    return re.split(r"(?<=\.)\s", " ".join(comment))[0]


def page():
    """The project file with the rooms, from the lowest to the highest."""
    held = held_in_rooms()
    parts = [(ROOT/"scripts/dev/ford.md").read_text(encoding="utf-8").rstrip()]
    modules = {}
    for path in sorted(SOURCE.rglob("*.f90")):
        if ".absent." not in path.name and ".band." not in path.name:
            modules.setdefault(room_of(path), []).append(path)
    for room in (FACADE, *MAY_USE, APP):
        parts.append(f"## {'The facade' if room == FACADE else room}\n\n{held.get(room, '')}".rstrip())
        parts.append("\n".join(f"* [[{module_name(path)}]]: {first_sentence(path)}" for path in modules.pop(room)
                               if path.name != "main.f90"))
    assert not modules, modules
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    print(page(), end="")
