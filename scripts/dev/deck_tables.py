#!/usr/bin/env python3
"""Compares the tables of keys in doc/decks.md with the program's own reference; --update puts the program's in.

Usage: deck_tables.py PROGRAM [--update]

A table stands between the lines <!-- amontons --reference GROUP --> and <!-- end of reference -->.
"""
import difflib
import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "doc" / "decks.md"
TABLE = re.compile(r"(?<=<!-- amontons --reference )(\w+)( -->\n).*?(?=<!-- end of reference -->)", re.DOTALL)


def reference(program, *groups):
    """The body of each group's reference, without its heading, by name."""
    text = subprocess.run([program, "--reference", *groups], check=True, capture_output=True, encoding="utf-8").stdout
    parts = re.split(r"^### `&(\w+)`.*\n\n", text, flags=re.MULTILINE)
    return {group: body.rstrip() for group, body in zip(parts[1::2], parts[2::2])}


def main():
    """Returns the exit status."""
    bodies = reference(sys.argv[1])
    old = PAGE.read_text(encoding="utf-8")
    shown = []

    def put_in(match):
        shown.append(match[1])
        return match[1] + match[2] + bodies[match[1]] + "\n"

    new = TABLE.sub(put_in, old)
    missing = [group for group in bodies if group not in shown]
    if missing:
        print(f"doc/decks.md has no place for the reference of {', '.join(missing)}")
        return 1
    if "--update" in sys.argv[2:]:
        PAGE.write_text(new, encoding="utf-8")
        return 0
    print(*difflib.unified_diff(old.splitlines(), new.splitlines(), "doc/decks.md", "amontons --reference", "", "", 0,
                                ""), sep="\n", end="\n" if new != old else "")
    return 0 if new == old else 1


if __name__ == "__main__":
    sys.exit(main())
