#!/usr/bin/env python3
"""Checks that every relative link of the Markdown pages leads to a file, and its anchor to a heading; that the names of
procedures, modules and tests that the pages on the sources give are still there.

Usage: check_links.py [ROOT]
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(sys.argv[1]).resolve() if sys.argv[1:] else Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^ *(```|~~~)")
HEADING = re.compile(r"^#{1,6} +(.*?) *#*$")
CODE = re.compile(r"(`+).+?\1")
# The target may go on behind a line break; its text may hold an image.
LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?[^)]*\)|^ {0,3}\[[^\]]+\]:\s+<?([^\s>]+)", re.MULTILINE)
# Names with an underscore in code on these pages; placeholders have capitals.
PAGES_ON_SOURCES = ("doc/architecture.md",)
NAME = re.compile(r"(?<![\w./])[a-z]\w*_[a-z0-9_]+\b")
FOREIGN = re.compile(r"[a-z][a-z+.-]*:", re.IGNORECASE)


def prose_lines(text):
    """The lines of a page, those of code blocks empty."""
    in_code = False
    for line in text.splitlines():
        is_fence = bool(FENCE.match(line))
        yield "" if in_code or is_fence else line
        in_code ^= is_fence


def anchors(text):
    """The anchors that headings have, as GitHub and Pandoc name them."""
    found = {}
    for line in prose_lines(text):
        if not (heading := HEADING.match(line)):
            continue
        words = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading[1])
        slug = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
        n_before = found[slug] = found.get(slug, -1) + 1
        yield f"{slug}-{n_before}" if n_before else slug


def links(text):
    """Line number and target of every link outside of code."""
    prose = "\n".join(CODE.sub("``", line) for line in prose_lines(text))
    for match in LINK.finditer(prose):
        yield prose.count("\n", 0, match.start()) + 1, match[1] or match[2]


def faults_of_page(page):
    """Line number and text of every fault of a page."""
    text = page.read_text(encoding="utf-8")
    for number, target in links(text):
        if FOREIGN.match(target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists():
            yield number, f"there is no {name}"
        elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text(encoding="utf-8")):
            yield number, f"{file.relative_to(ROOT)} has no heading #{anchor}"


def files(*patterns):
    """The files of the repository that fit one of the patterns, those that are not yet added included."""
    names = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", *patterns], cwd=ROOT,
                           check=True, capture_output=True, encoding="utf-8").stdout.splitlines()
    return [ROOT / name for name in sorted(names) if (ROOT / name).is_file()]


def source_names():
    """Every word in sources and scripts, and the names that CMake gives their tests."""
    found = set()
    for file in files("src", "tests", "scripts", "cmake", "python", "CMakeLists.txt"):
        found.add(file.name.split(".")[0])
        if file.name.startswith("test_"):
            found.add(file.stem.replace("test_", "verification_" if file.parent.name == "verification" else "program_"))
        found.update(re.findall(r"\w+", file.read_text(encoding="utf-8", errors="replace")))
    return found


def faults_of_names(page, names):
    """Line number and text of every name on a page that the sources do not have."""
    for number, line in enumerate(prose_lines(page.read_text(encoding="utf-8")), start=1):
        for code in CODE.finditer(line):
            for name in NAME.findall(code[0]):
                if name not in names:
                    yield number, f"the sources have no {name}"


def main():
    """Prints the faults of all pages; returns the exit status."""
    pages, names = files("*.md"), source_names()
    faults = [(page, *fault) for page in pages for fault in faults_of_page(page)]
    faults += [(page, *fault) for page in pages if str(page.relative_to(ROOT)) in PAGES_ON_SOURCES
               for fault in faults_of_names(page, names)]
    for page, number, text in faults:
        print(f"{page.relative_to(ROOT)}:{number}: {text}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
