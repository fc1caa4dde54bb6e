#!/usr/bin/env python3
"""Turns a unit test file (.pf) into Fortran.

Every directive becomes plain Fortran that knows its line of the .pf file. After the test module comes a module
`wrap<name>` with the procedure `<name>_suite`, which hands the tests to the runner. What is not in the subset that
README.md describes is refused, as `file:line: error: ...` and with status 1; output is written only on success.
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

MAX_COLUMNS = 120
MAX_MODULE_NAME = 57
ASSERTIONS = {name.lower(): name for name in """
    assertTrue assertFalse assertAny assertAll assertNone assertNotAll assertEqual assertNotEqual assertLessThan
    assertLessThanOrEqual assertGreaterThan assertGreaterThanOrEqual assertRelativelyEqual assertIsNaN
    assertIsFinite assertExceptionRaised assertFail""".split()}

DIRECTIVE = re.compile(r"\s*@(\w*)(.*)")
CONDITION = re.compile(r"\((ifdef|ifndef)=([A-Za-z_]\w*)\)")
PLAIN_SUBROUTINE = re.compile(r"\s*subroutine\s+(\w+)\s*(?:\(\s*\))?\s*", re.IGNORECASE)
MODULE = re.compile(r"\s*module\s+(\w+)\s*(.*)", re.IGNORECASE)
USE_FUNIT = re.compile(r"\s*use\b(?:\s*,\s*\w+)?\s*(?:::)?\s*funit\b(.*)", re.IGNORECASE)
PLAIN_USE_FUNIT = re.compile(r"\s*use\s+funit\s*(?:!.*)?", re.IGNORECASE)
CONTAINS = re.compile(r"\s*contains\s*(?:!.*)?", re.IGNORECASE)


class Refusal(Exception):
    """A line of the .pf file is outside the subset."""

    def __init__(self, line: int, message: str):
        super().__init__(message)
        self.line = line


@dataclass
class Test:
    """A test, and the preprocessor condition under which it exists."""

    line: int
    condition: str = ""
    is_disabled: bool = False
    name: str = ""


@dataclass
class Suite:
    """What a .pf file has told so far."""

    name: str
    module_line: int = 0
    has_funit: bool = False
    has_contains: bool = False
    tests: list = field(default_factory=list)
    hooks: dict = field(default_factory=dict)
    waiting: object = None  # the Test, or the name of the hook, whose subroutine comes next


def located(line: int, *statements: str) -> list:
    """Fortran lines that the compiler places on one line of the .pf file."""
    return [text for statement in statements for text in (f"#line {line}", statement)]


def arguments_of(line: int, text: str) -> str:
    """The inside of the parentheses that make up the whole text."""
    if not text.startswith("("):
        raise Refusal(line, "expected '(' directly after the name of the directive")
    open_brackets = []
    quote = ""
    for position, character in enumerate(text):
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character in "([":
            open_brackets.append(character)
        elif character in ")]":
            if open_brackets.pop() + character not in ("()", "[]"):
                raise Refusal(line, "unbalanced parentheses")
            if not open_brackets:
                if text[position + 1:].strip():
                    raise Refusal(line, "a directive has nothing after it on its line")
                return text[1:position].strip()
        elif character in "!&;":
            raise Refusal(line, "a directive is whole on its line, without comment and continuation")
    raise Refusal(line, "unbalanced " + ("quotes" if quote else "parentheses"))


def assertion(line: int, name: str, text: str, file_name: str) -> list:
    """The call an assertion stands for, and the return when it failed."""
    arguments = arguments_of(line, text)
    call = [f"call {name}( &", f"{arguments}, &"] if arguments else [f"call {name}( &"]
    return located(line, *call, f"location=SourceLocation('{file_name}', {line}))", "if (anyExceptions()) return")


def expect_subroutine(line: int, text: str, suite: Suite) -> None:
    """Takes the line after a directive that announces a subroutine."""
    match = PLAIN_SUBROUTINE.fullmatch(text)
    if not match:
        kind = "test" if isinstance(suite.waiting, Test) else suite.waiting
        raise Refusal(line, f"expected 'subroutine name()' after @{kind}")
    name = match.group(1)
    if isinstance(suite.waiting, Test):
        if name.lower() in (test.name.lower() for test in suite.tests):
            raise Refusal(line, f"a second test named {name}")
        suite.waiting.name, suite.waiting.line = name, line
        suite.tests.append(suite.waiting)
    else:
        suite.hooks[suite.waiting] = name
    suite.waiting = None


def announce(line: int, name: str, text: str, suite: Suite) -> None:
    """Takes @test, @disable, @before or @after."""
    if name == "disable":
        if not isinstance(suite.waiting, Test) or suite.waiting.is_disabled:
            raise Refusal(line, "@disable stands once, between @test and its subroutine")
        suite.waiting.is_disabled = True
    elif suite.waiting:
        expect_subroutine(line, "@" + name, suite)
    elif name == "test":
        condition = CONDITION.fullmatch(text)
        suite.waiting = Test(line, " ".join(condition.groups()) if condition else "")
        if condition:
            return
    elif name in suite.hooks:
        raise Refusal(line, f"a second @{name}")
    else:
        suite.waiting = name
    if text:
        raise Refusal(line, f"@{name} has nothing after it on its line" +
                      (" but (ifdef=NAME) or (ifndef=NAME)" if name == "test" else ""))


def directive(line: int, text: str, suite: Suite) -> list:
    """Takes a line that starts with @ and returns the Fortran in its place."""
    name, rest = DIRECTIVE.fullmatch(text).groups()
    if len(text) > MAX_COLUMNS:
        raise Refusal(line, f"a directive ends in column {MAX_COLUMNS} at the latest")
    if name.lower() in ("test", "disable", "before", "after"):
        announce(line, name.lower(), rest.strip(), suite)
        return [""]
    if name.lower() not in ASSERTIONS:
        raise Refusal(line, f"@{name} is no directive of the subset")
    if suite.waiting:
        expect_subroutine(line, text, suite)
    return assertion(line, ASSERTIONS[name.lower()], rest.rstrip(), f"{suite.name}.pf") + [f"#line {line + 1}"]


def check_statement(line: int, text: str, suite: Suite) -> None:
    """Takes a line of Fortran: the rules for module and use statements."""
    module = MODULE.fullmatch(text)
    if not suite.module_line:
        if not module or module.groups() != (suite.name, ""):
            raise Refusal(line, f"the first statement is 'module {suite.name}', alone on its line")
        suite.module_line = line
    elif module and not module.group(2):
        raise Refusal(line, "a .pf file has one module")
    if USE_FUNIT.fullmatch(text):
        if suite.has_funit or suite.has_contains or not PLAIN_USE_FUNIT.fullmatch(text):
            raise Refusal(line, "'use funit' stands once, at module level, without 'only'")
        suite.has_funit = True
    if CONTAINS.fullmatch(text):
        suite.has_contains = True
    if suite.waiting:
        expect_subroutine(line, text, suite)


def translate(line: int, text: str, suite: Suite) -> list:
    """The Fortran for one line of the .pf file."""
    if text.endswith("\\") or "/*" in text:
        raise Refusal(line, "the preprocessor cpp would take '\\' at the end of a line, or '/*', for its own")
    bare = text.strip()
    if bare.startswith("@"):
        return directive(line, text, suite)
    if bare and bare[0] not in "!#":
        check_statement(line, text, suite)
    elif suite.waiting and (bare.startswith("#") or not isinstance(suite.waiting, Test)):
        expect_subroutine(line, text, suite)
    return [text]


def registration(suite: Suite) -> list:
    """The module that hands the tests to the runner.

    Its local names `t` and `suite` and its unrestricted use of the test module are on purpose: a test module that
    owns one of these names is refused by pFUnit, so it must not compile here either.
    """
    hooks = "".join(f", {hook}={name}" for hook, name in suite.hooks.items())
    lines = located(
        suite.module_line,
        f"module wrap{suite.name}",
        "implicit none (type, external)",
        "contains",
        f"subroutine {suite.name}_suite(t)",
        "use funit",
        f"use {suite.name}",
        "use funit_runner, only: funit_runner_t",
        "type(funit_runner_t), intent(inout) :: t",
        f"character(*), parameter :: suite = '{suite.name}_suite'",
        f"call t%start_suite(suite{hooks})")
    for test in suite.tests:
        call = f"call t%disable('{test.name}')" if test.is_disabled else f"call t%run('{test.name}', {test.name})"
        statement = located(test.line, call)
        lines += [f"#{test.condition}", *statement, "#endif"] if test.condition else statement
    return lines + located(suite.module_line, f"end subroutine {suite.name}_suite", f"end module wrap{suite.name}")


def preprocess(source: Path) -> str:
    """The Fortran text for a .pf file."""
    suite = Suite(source.stem)
    if not re.fullmatch(rf"(?!wrap|pf_|loader$)[a-z]\w{{0,{MAX_MODULE_NAME - 1}}}", suite.name) \
            or suite.name != suite.name.lower():
        raise Refusal(1, "the file name is no module name of the subset: lower case, at most "
                         f"{MAX_MODULE_NAME} characters, not 'loader', not starting with 'pf_' or 'wrap'")
    texts = source.read_text(encoding="utf-8").split("\n")
    lines = [f'#line 1 "{source.resolve()}"']
    for number, text in enumerate(texts, start=1):
        lines += translate(number, text, suite)
    if suite.waiting:
        expect_subroutine(len(texts), "", suite)
    if not suite.has_funit:
        raise Refusal(max(suite.module_line, 1), "'use funit' is missing")
    return "\n".join(lines + registration(suite)) + "\n"


def main() -> int:
    """Reads the file named first and writes the file named second."""
    if len(sys.argv) != 3:
        print("usage: funit_preprocess.py INPUT.pf OUTPUT.F90", file=sys.stderr)
        return 1
    try:
        text = preprocess(Path(sys.argv[1]))
        Path(sys.argv[2]).write_text(text, encoding="utf-8")
    except Refusal as refusal:
        print(f"{sys.argv[1]}:{refusal.line}: error: {refusal}", file=sys.stderr)
        return 1
    except (OSError, UnicodeError) as failure:
        print(f"{sys.argv[1]}: error: {failure}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
