#!/usr/bin/env python3
"""Checks that no sentence of the Markdown pages has more than 40 words. Tables, code and formulas are not counted.

Usage: check_sentences.py [ROOT]
"""
import re
import sys
from pathlib import Path

ROOT = Path(sys.argv[1]).resolve() if sys.argv[1:] else Path(__file__).resolve().parents[2]
LONGEST = 40
# What ends with a full stop and is no end of a sentence.
SHORT = re.compile(r"\b(?:[A-Z]|e\.g|i\.e|etc|vol|no|pp?|ed|Proc|Camb|Phil|Soc|Int|Appl|Phys|Exp|Mech|Struct|Mater|"
                   r"Math|Comput|Methods|Anal|Numer|Eng|Trans|Roy|Lond)\.(?= )")


def paragraphs(text):
    """First line and text of every paragraph and item of prose."""
    in_code, start, words = False, 0, []
    for number, line in enumerate([*text.splitlines(), ""], start=1):
        is_fence = bool(re.match(r" *(```|~~~)", line))
        begins = re.match(r" *([*+-]|\d+\.) ", line)
        ends = is_fence or in_code or not line.strip() or re.match(r" *[#|<]|    \S.*", line) and not words
        if (ends or begins or re.match(r" *[#|]", line)) and words:
            yield start, " ".join(words)
            words = []
        in_code ^= is_fence
        if ends or re.match(r" *[#|<]", line):
            continue
        start = start if words else number
        words.append(re.sub(r"^ *([*+-]|\d+\.) ", "", line).strip())


def sentences(paragraph):
    """The sentences of a paragraph; code, formulas and links count as a word each."""
    paragraph = re.sub(r"`+[^`]*`+|\$[^$]+\$", "x", paragraph)
    paragraph = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", paragraph)
    return re.split(r"(?<=[.!?])[)*\"']*\s+", SHORT.sub("x", paragraph))


def main():
    """Prints the sentences that are too long; returns the exit status."""
    n_faults = 0
    for page in [ROOT / "README.md", *sorted((ROOT / "doc").glob("*.md"))]:
        for number, paragraph in paragraphs(page.read_text(encoding="utf-8")):
            for sentence in sentences(paragraph):
                n_words = len(re.findall(r"\w+(?:['’.-]\w+)*", sentence))
                if n_words > LONGEST:
                    n_faults += 1
                    print(f"{page.relative_to(ROOT)}:{number}: a sentence of {n_words} words, at most {LONGEST}: "
                          f"{sentence[:70]} ...")
    return 1 if n_faults else 0


if __name__ == "__main__":
    sys.exit(main())
