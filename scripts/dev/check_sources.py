#!/usr/bin/env python3
"""Checks the rules of the code that no common linter knows: lengths, comments, no output and no stop in the library.

Usage: check_sources.py [ROOT]

* A line has at most 120 columns, a file 900 lines, a Fortran procedure 150 lines: wide nets, places to look.
* `!>` stands above every module, program, type, generic interface, procedure and public constant of src/; `!!` stands
  at every dummy argument and component, one per declaration. Interfaces of foreign procedures are exempt.
* What `use, only` and `import` name is used, and a private procedure is called, in src/. A public name of a module in
  src/, other than the two that users take, is one that another module or a test takes.
* A constant that is a tolerance, a small number, has its reason in a comment above it or behind it.
* The library neither stops nor prints; nothing passes through a preprocessor.
"""
import re
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ["src", "tests", "scripts", "cmake", "python", "packaging", ".ci", "findings"]
MAX_COLUMNS, MAX_FILE_LINES, MAX_PROCEDURE_LINES = 120, 900, 150
FORTRAN = (".f90", ".f90.in", ".pf")
FACADE = ("amontons.f90", "amontons_decks.f90")
TEXT = (*FORTRAN, ".c", ".h", ".py", ".sh", ".cmake", "CMakeLists.txt")

UNIT = re.compile(r"(module|program|submodule)\b(?!\s*(procedure|subroutine|function)\b)")
END_UNIT = re.compile(r"end\s*(module|program|submodule)\b")
TYPE = re.compile(r"type\s*(,[^:]*)?(::|\s)\s*\w+$")
INTERFACE = re.compile(r"(abstract\s+)?interface\b(?P<name>.*)")
PROCEDURE = re.compile(
    r"(?:(?:pure|impure|elemental|recursive|non_recursive|module|(?:type|class|real|integer|character|logical)"
    r"\s*\([^()]*(?:\([^()]*\))*[^()]*\)|real|integer|logical|complex|double\s+precision)\s+)*"
    r"(?P<kind>subroutine|function)\s+\w+\s*(?:\((?P<arguments>[^()]*)\))?")
DECLARATION = re.compile(
    r"(?:integer|real|double|complex|logical|character|type|class|procedure)\b(?P<attributes>[^=:]*)::(?P<names>.*)")
END_PROCEDURE = re.compile(r"end\s*(subroutine|function|procedure)\b")
# At the beginning of a statement, behind its label or behind the condition of an `if`.
STOP_OR_PRINT = re.compile(
    r"(?:^(?:\d+\s+)?|\)\s*)(?:(?:error\s*)?stop\b(?!\s*[=(%])|print\b\s*[*'\"(\w]|call\s+(?:exit|abort)\b)"
    r"|\bwrite\s*\(\s*(?:[^()]*\bunit\s*=\s*)?(?:\*|[06]\s*[,)]|output_unit|error_unit)")
# gfortran 14 checks the bounds of a(:, findloc(...)) before findloc has run; those of x => a(:, size(...)) likewise.
SEARCH_IN_SECTION = re.compile(
    r"\([^()]*:[^()]*,\s*(?:find|min|max)loc\s*\(|=>\s*\w+\([^()]*:[^()]*,\s*size\s*\(", re.IGNORECASE)
USE = re.compile(r"(?:use\b[^:]*(?:::)?\s*\w+\s*,\s*only\s*:|import\s*::)(?P<names>.*)")
# A component, a binding or the name of an argument in a call: not what an import or a procedure of that name is.
OTHER_NAME = re.compile(r"%\s*\w+|(?<=[(,])\s*\w+\s*=(?![=>])")
# Constants that are small numbers: negative powers of ten, or some rounding errors of 1.
CONSTANTS = re.compile(r"\s*(?:real|double)\b.*\bparameter\b.*?::(.*)")
SMALL = re.compile(r"\s*(\w+)[^=]*=.*(?:\de-\d|\bepsilon\()")
C_STOP_OR_PRINT = re.compile(r"\b(?:printf|fprintf|puts|putchar|perror|exit|abort|assert)\s*\(")


@dataclass
class Statement:
    """A Fortran statement: its lines, its lower-case code without strings and comments, and its `!>` and `!!`."""
    first: int
    last: int
    code: str
    has_heading: bool
    has_note: bool


def split_comment(line, quote=""):
    """Returns the code of a line, strings emptied, its comment, and the quote of a string that goes on."""
    code = ""
    for column, character in enumerate(line):
        if quote:
            if character == quote:
                quote = ""
                code += character
        elif character == "!":
            return code, line[column:], ""
        else:
            if character in "'\"":
                quote = character
            code += character
    # A string goes on in the next line where an ampersand ends this one.
    is_open = bool(quote) and line.rstrip().endswith("&")
    return code + "&"*is_open, "", quote if is_open else ""


def split_comments(lines):
    """Returns code and comment of each line."""
    parts, quote = [], ""
    for line in lines:
        code, comment, quote = split_comment(line, quote)
        parts.append((code, comment))
    return parts


def statements_of(lines):
    """Yields the statements of free-form Fortran, those that share a line one by one."""
    parts = split_comments(lines)
    number = 0
    while number < len(parts):
        code, comment = parts[number]
        if not code.strip():
            number += 1
            continue
        first, has_note, text = number, comment.startswith("!!"), code.strip()
        while text.endswith("&") and number + 1 < len(parts):
            number += 1
            code, comment = parts[number]
            has_note = has_note or comment.startswith("!!")
            text = text[:-1] + " " + code.strip().removeprefix("&") if code.strip() else text
        number += 1
        has_note = has_note or number < len(lines) and lines[number].strip().startswith("!!")
        for part in text.lower().split(";"):
            if part.strip():
                yield Statement(first + 1, number, part.strip(), has_heading(lines, first), has_note)


def has_heading(lines, first):
    """Returns whether the comment right above a line holds a `!>`."""
    above = first - 1
    while above >= 0 and lines[above].strip().startswith("!"):
        if lines[above].strip().startswith("!>"):
            return True
        above -= 1
    return False


def without_parentheses(code):
    """Returns code without what stands in parentheses or brackets."""
    while (shorter := re.sub(r"\([^()]*\)|\[[^][]*\]", "", code)) != code:
        code = shorter
    return code


def declared_names(names):
    """Returns the names in what stands behind the colons of a declaration."""
    return [re.match(r"\s*(\w*)", name)[1] for name in without_parentheses(names).split(",")]


def public_names_of(statement):
    """Returns the names of a module that a statement makes public: those of a list, or constants."""
    if match := re.match(r"public\b(?!\s*[=(%])\s*(?:::)?(.*)", statement.code):
        return declared_names(match[1])
    match = DECLARATION.match(without_parentheses(statement.code))
    is_public = match and {"parameter", "public"}.issubset(re.findall(r"\w+", match["attributes"]))
    return declared_names(match["names"]) if is_public else []


def public_names(statements):
    """Returns the names that a module makes public; None, which stands for all, for one without `private`."""
    if any(s.code.startswith("module ") for s in statements) and all(s.code != "private" for s in statements):
        return None
    return {name for s in statements for name in public_names_of(s)}


def comment_faults(statements):
    """Yields line number and text of every comment that is missing."""
    public = public_names(statements)
    arguments = None
    in_type = has_components = in_foreign_interface = False
    for s in statements:
        if in_foreign_interface:
            in_foreign_interface = not re.match(r"end\s*interface\b", s.code)
        elif in_type:
            in_type = not re.match(r"end\s*type\b", s.code)
            has_components = has_components and s.code != "contains"
            if has_components and DECLARATION.match(without_parentheses(s.code)) and not s.has_note:
                yield s.first, "no !! at this component"
        elif TYPE.match(s.code) or UNIT.match(s.code):
            in_type = has_components = bool(TYPE.match(s.code))
            if not s.has_heading:
                yield s.first, f"no !> above this {s.code.split()[0].strip(',')}"
        elif match := INTERFACE.match(s.code):
            in_foreign_interface = not match[1] and not match["name"].strip()
            if match["name"].strip() and not s.has_heading:
                yield s.first, "no !> above this interface"
        elif match := PROCEDURE.match(s.code):
            arguments = {name.strip() for name in (match["arguments"] or "").split(",")}
            if not s.has_heading:
                yield s.first, f"no !> above this {match['kind']}"
        elif END_PROCEDURE.match(s.code):
            arguments = None
        elif match := DECLARATION.match(without_parentheses(s.code)):
            names = declared_names(match["names"])
            is_public = public is None or public.intersection(names)
            if arguments is None and is_public and not (s.has_heading or s.has_note):
                yield s.first, "no !> above this public constant"
            elif arguments and (named := arguments.intersection(names)):
                if not s.has_note:
                    yield s.first, f"no !! at this argument: {', '.join(sorted(named))}"
                elif len(names) > 1:
                    yield s.first, f"one declaration per argument: {', '.join(sorted(named))}"


def names_in(code):
    """Returns the names that a statement uses, kinds of numbers included; not those of components and arguments."""
    return set(re.findall(r"\b[a-z]\w*|(?<=[0-9.]_)[a-z]\w*", OTHER_NAME.sub("", code)))


def import_faults(statements, lines):
    """Yields line number and text of every name that a file imports and never uses; directives of OpenMP use names."""
    imports = [(s, match["names"]) for s in statements if (match := USE.match(s.code))]
    used = names_in(" ".join(line.lower() for line in lines if line.strip().lower().startswith("!$omp")))
    used = used.union(*(names_in(s.code) for s in statements if not re.match(r"(use|import)\b", s.code)))
    for s, names in imports:
        for name in (name.split("=>")[0].strip() for name in names.split(",")):
            if re.match(r"\w+$", name) and name not in used:
                yield s.first, f"imported and never used: {name}"


def call_faults(statements):
    """Yields line number and text of every private procedure that nothing but itself calls."""
    public = public_names(statements)
    begun, defined, called = [], {}, set()
    in_interface = False
    for s in statements:
        if END_PROCEDURE.match(s.code) and begun:
            begun.pop()
        elif INTERFACE.match(s.code) or re.match(r"end\s*interface\b", s.code):
            in_interface = not s.code.startswith("end")
        elif (match := PROCEDURE.match(s.code)) and not in_interface:
            name = re.search(match["kind"] + r"\s+(\w+)", s.code)[1]
            begun.append(name)
            if (len(begun) > 1 or public is not None and name not in public) and "bind(" not in s.code:
                defined[name] = s.first
        elif not re.match(r"(private|public)\b", s.code):
            called |= names_in(s.code) - set(begun)
    for name in defined.keys() - called:
        yield defined[name], f"a private procedure that nothing calls: {name}"


def reach_faults(root, files):
    """Yields file, line number and text of every public name that no other file imports."""
    public, imported = [], set()
    for path in files:
        statements = list(statements_of(path.read_text(encoding="utf-8").splitlines()))
        relative = path.relative_to(root)
        if relative.parts[0] == "src" and relative.name not in FACADE:
            public += [(path, s.first, name) for s in statements for name in public_names_of(s)]
        for names in (match["names"] for s in statements if (match := USE.match(s.code))):
            imported |= {name.split("=>")[-1].strip() for name in names.split(",")}
    for path, number, name in public:
        if name not in imported:
            yield path, number, f"public, and no other module takes it: {name}"


def length_faults(statements):
    """Yields line number and text of every procedure that is too long."""
    begun = []
    for s in statements:
        if PROCEDURE.match(s.code) or re.match(r"module\s+procedure\s+\w+$", s.code):
            begun.append(s.first)
        elif END_PROCEDURE.match(s.code) and begun:
            length = s.last - begun[-1] + 1
            if length > MAX_PROCEDURE_LINES:
                yield begun[-1], f"a procedure of {length} lines, at most {MAX_PROCEDURE_LINES}"
            begun.pop()


def tolerances_of(lines):
    """Yields line number and names of each declaration of tolerances, and whether a comment gives a reason."""
    for number, (code, comment) in enumerate(split_comments(lines), start=1):
        match = CONSTANTS.match(code.lower())
        parts = re.split(r",(?=\s*\w+(?:\([^()]*\))?\s*=)", match[1]) if match else []
        if names := [small[1] for part in parts if (small := SMALL.match(part))]:
            above = lines[number - 2].strip() if number > 1 else ""
            yield number, names, any(text.startswith(("! ", "!> ")) for text in (comment, above))


def faults_of_file(path, root=ROOT):
    """Yields line number and text of every fault of one file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    relative = path.relative_to(root)
    in_library = relative.parts[0] == "src" and relative.parts[1] != "app"
    if len(lines) > MAX_FILE_LINES:
        yield 1, f"a file of {len(lines)} lines, at most {MAX_FILE_LINES}"
    for number, line in enumerate(lines, start=1):
        if len(line) > MAX_COLUMNS:
            yield number, f"a line of {len(line)} columns, at most {MAX_COLUMNS}"
        if relative.parts[0] == "src" and line.startswith("#") and path.name.endswith(FORTRAN):
            yield number, "a preprocessor line"
        if in_library and path.suffix in (".c", ".h") and C_STOP_OR_PRINT.search(line):
            yield number, "the library neither stops nor prints"
    if not path.name.endswith(FORTRAN):
        return
    statements = list(statements_of(lines))
    yield from length_faults(statements)
    for s in statements:
        if SEARCH_IN_SECTION.search(s.code):
            yield s.first, "the result of findloc, minloc, maxloc, size beside a section: give it a name first"
    if relative.parts[0] == "src":
        yield from comment_faults(statements)
        yield from import_faults(statements, lines)
        yield from call_faults(statements)
        for number, names, has_reason in tolerances_of(lines):
            if not has_reason:
                yield number, f"a tolerance without its reason: {', '.join(names)}"
    if in_library:
        for s in statements:
            if STOP_OR_PRINT.search(s.code):
                yield s.first, "the library neither stops nor prints"


def main(root=ROOT):
    """Prints the faults of all files; returns the exit status."""
    root = Path(root).resolve()
    files = sorted(path for folder in FOLDERS for path in (root / folder).rglob("*") if path.is_file())
    faults = []
    for path in files:
        if path.suffix in (".F90", ".F", ".fpp", ".inc"):
            faults.append((path, 1, "a file for the preprocessor"))
        elif path.name.endswith(TEXT):
            faults += [(path, *fault) for fault in faults_of_file(path, root)]
    faults += reach_faults(root, [path for path in files if path.name.endswith(FORTRAN)])
    for path, number, text in faults:
        print(f"{path.relative_to(root)}:{number}: {text}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:2]))
