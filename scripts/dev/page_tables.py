#!/usr/bin/env python3
"""Compares the tables of the pages with where their words come from; --update puts these in.

Usage: page_tables.py PROGRAM [--update]

A table stands between two lines that begin with <!-- from and <!-- end. What it is from is one of

    amontons --reference GROUP      the keys of a group of decks, as the program prints them
    amontons.1 SECTION              the paragraphs of a section of the manual page, each below its heading
    sources: NAME                   comments of the sources, `!=NAME names | unit | meaning`, in the order of the files;
                                    a line that begins with `!=   ` continues the one before
    tolerances shared               the constants of `amontons_rounding`, their values and the comments above them
    tolerances own                  the names of those of other modules, by rooms
"""
import difflib
import re
import subprocess
import sys
from pathlib import Path

from check_sources import tolerances_of

ROOT = Path(__file__).resolve().parents[2]
# What it is from, its head, its rows.
TABLE = re.compile(r"(?<=<!-- from )([^\n]*?)( -->\n(?:\|[^\n]*\n\|[-|]*\n)?).*?(?=<!-- end)", re.DOTALL)


def reference(program):
    """The table of each group of decks, by its name."""
    text = subprocess.run([program, "--reference"], check=True, capture_output=True, encoding="utf-8").stdout
    parts = re.split(r"^### `&(\w+)`.*\n\n", text, flags=re.MULTILINE)
    return {group: body.strip() + "\n" for group, body in zip(parts[1::2], parts[2::2])}


def rows_of_manual(section):
    """The rows of a section of the manual page: each heading as code, and what follows it."""
    text = (ROOT / "doc" / "amontons.1").read_text(encoding="utf-8").replace("\\-", "-")
    body = re.search(rf"^\.SH {section}\n(.*?)^\.SH", text, re.DOTALL | re.MULTILINE)[1]
    for paragraph in body.split(".TP\n")[1:]:
        heading, *lines = paragraph.splitlines()
        words = " ".join(line if not line.startswith(".") else marked(line) for line in lines)
        yield f"| {marked(heading)} | {words} |"


def marked(line):
    """A line of the manual page in another type, as code: .B all of it, .BI of --output " DIR" too, .BR of a word the
    first one."""
    kind, words = line.split(" ", 1)
    parts = [part.strip('"') for part in re.findall(r'"[^"]*"|\S+', words)]
    if kind in (".BR", ".IR") and len(parts) > 1:
        return f"`{parts[0]}`{''.join(parts[1:])}"
    return f"`{''.join(parts) if kind == '.BI' else words.strip(chr(34))}`"


def rows_of_comments(name):
    """The rows in the comments of source files."""
    for file in sorted((ROOT / "src").rglob("*.f90")):
        text = re.sub(r"\n *!=   ", " ", file.read_text(encoding="utf-8"))
        yield from (f"| {row} |" for row in re.findall(rf"^ *!={re.escape(name)} (.*)$", text, re.MULTILINE))


def rows_of_tolerances(kind):
    """The rows of the constants that modules share, or of the rooms whose modules have their own."""
    shared = ROOT / "src" / "base" / "amontons_rounding.f90"
    if kind == "shared":
        found = re.findall(r"((?: *!> .*\n)+) *real\(dp\), parameter, public :: (\w+) = (\S+)_dp$",
                           shared.read_text(encoding="utf-8"), re.MULTILINE)
        for comment, name, value in found:
            reason = " ".join(line.strip().removeprefix("!> ") for line in comment.splitlines())
            yield f"| `{name}` | {value.replace('1.0e', '1e')} | {reason} |"
        return
    rooms = {}
    for file in sorted((ROOT / "src").rglob("*.f90")):
        lines = file.read_text(encoding="utf-8").splitlines()
        if file != shared and (names := [name for _, part, _ in tolerances_of(lines) for name in part]):
            words = ", ".join(f"`{name}`" for name in dict.fromkeys(names))
            rooms.setdefault(file.parent.relative_to(ROOT / "src"), []).append(
                f"{file.stem.removeprefix('amontons_')} {words}")
    yield from (f"| `{room}` | {'; '.join(parts)} |" for room, parts in sorted(rooms.items()))


def main():
    """Returns the exit status."""
    bodies, shown, status = reference(sys.argv[1]), [], 0

    def put_in(match):
        kind, *names = match[1].split()
        if kind == "amontons":
            shown.append(names[-1])
            return match[1] + " -->\n" + bodies[names[-1]]
        rows = {"amontons.1": lambda: rows_of_manual(" ".join(names)), "sources:": lambda: rows_of_comments(*names),
                "tolerances": lambda: rows_of_tolerances(*names)}[kind]()
        return match[1] + match[2] + "\n".join(rows) + "\n"

    for page in sorted((ROOT / "doc").glob("*.md")):
        old = page.read_text(encoding="utf-8")
        new = TABLE.sub(put_in, old)
        if new != old and "--update" in sys.argv[2:]:
            page.write_text(new, encoding="utf-8")
        elif new != old:
            status = 1
            print(*difflib.unified_diff(old.splitlines(), new.splitlines(), str(page.relative_to(ROOT)), "its source",
                                        "", "", 0, ""), sep="\n")
    if missing := [group for group in bodies if group not in shown]:
        print(f"the pages have no place for the reference of {', '.join(missing)}")
        status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
