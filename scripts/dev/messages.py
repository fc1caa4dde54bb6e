"""The statements of src/ that make an error message."""
import re
from dataclasses import dataclass
from pathlib import Path

from check_sources import ROOT, split_comment, statements_of

# The procedures that raise or record a fault, and the variables that hold the sentence for them.
MAKE = re.compile(r"\bcall\s+(?:[\w%()]*%refuse\w*|[\w%()]*%fault|[\w%()]*faults%add|new_error|refuse\w*|complain)\s*\("
                  r"|(?<!\w)(?:misfit|sentence|reason|message)\s*=(?!=)\s*(?!''\s*$)")
# Rules of a description are stated in calls that are always made; they raise their sentence where they do not hold.
RULE = re.compile(r"\bcall\s+visitor%(?P<kind>require|only)\s*\((?P<arguments>.*)\)")
# `! not raised: REASON` above or beside such a statement tells why no test raises it.
WAIVER = re.compile(r"! not raised: \S")


@dataclass
class Message:
    """A statement that makes an error message."""
    path: Path
    first: int
    last: int
    text: str  # the statement, or the sentence of a rule
    is_waived: bool = False  # whether a comment tells why no test raises it
    is_expected: bool = False  # of a rule, whether the text of a test holds the sentence

    def __str__(self):
        return f"{self.path.relative_to(ROOT)}:{self.first}"


def statements():
    """Yields file, lines, statement and its text on one line, for all statements of the sources."""
    for path in sorted((ROOT/"src").rglob("*.f90")):
        lines = path.read_text(encoding="utf-8").splitlines()
        for statement in statements_of(lines):
            text = ""
            for line in lines[statement.first - 1:statement.last]:
                code = line[:len(line) - len(split_comment(line)[1])].strip()
                text += code.removesuffix("&").removeprefix("&")
            yield path, lines, statement, text


def messages():
    """Yields the statements that make a message when they are run."""
    for path, lines, statement, text in statements():
        if MAKE.search(statement.code):
            yield Message(path, statement.first, statement.last, text,
                          is_waived=any(map(WAIVER.search, lines[statement.first - 2:statement.last])))


def split_top(text, separator):
    """Splits an expression at a separator that stands outside quotes and parentheses."""
    parts, depth, quote = [""], 0, ""
    for i, character in enumerate(text):
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        else:
            depth += (character in "([") - (character in ")]")
        if depth == 0 and not quote and text.startswith(separator, i):
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts]


def pattern_of(expression):
    """The regular expression of a text expression: its literals, and anything for what stands between them."""
    pattern = ""
    for piece in filter(None, split_top(expression, "//")):
        match = re.fullmatch(r"/?\s*(['\"])(.*)\1", piece)
        pattern += re.escape(match[2].replace(match[1]*2, match[1])) if match else ".*"
    return pattern


def rules():
    """Yields the rules that a value of a deck is measured by, each with the sentence said where it breaks one."""
    files = [path for path in (ROOT/"tests").rglob("*") if path.suffix in (".nml", ".pf", ".py")]
    expected = "\n".join(path.read_text(encoding="utf-8") for path in files)
    for path, _, statement, text in statements():
        if match := RULE.search(text):
            arguments = split_top(match["arguments"], ",")
            pattern = pattern_of(arguments[-1])
            if match["kind"] == "only":
                pattern = f"{pattern_of(arguments[0])} is only for {pattern}"
            yield Message(path, statement.first, statement.last, pattern,
                          is_expected=bool(re.search(pattern, expected)))
