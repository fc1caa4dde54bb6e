#!/usr/bin/env python3
"""Checks that every test can fail: that it is run, and that it asks something.

Usage: check_tests.py [ROOT]
       check_tests.py --untested    lists the modules without unit tests of their own

* A test file of tests/ (`*.pf`, `test_*.py`) is named in the CMakeLists.txt of its folder, or in a benchmarks.txt that
  is read there, and the folder is added by the one above it.
* A .pf file is named after the module that it tests: tests/ROOM/test_NAME.pf, where src/ROOM has amontons_NAME.
* Every test of a .pf file comes to an assertion, in itself or in a procedure of tests/ that it calls.
* A test_*.py has test methods, and runs them when it is called.
"""
import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMMAND = re.compile(r"(\w+)\s*\(([^()]*)\)")
LOOP = re.compile(r"foreach\s*\(\s*(\w+)\s+([^()]*)\)\s*add_program_test\s*\(\s*\$\{\1\}")
BEGIN = re.compile(r"(?:[\w ]+\s)?(subroutine|function)\s+(\w+)", re.IGNORECASE)
END = re.compile(r"end\s*(subroutine|function)\b", re.IGNORECASE)
ASSERTION = re.compile(r"\s*@assert|.*\bcall\s+throw\b", re.IGNORECASE)
# Unit tests of the stand-in for pFUnit, which is no module of src/. Some show verdicts, and a script compares these.
STAND_IN = "funit"
VERDICTS = Path(STAND_IN, "conformance")


def commands(text):
    """Yields name and words of the commands of a CMakeLists.txt."""
    for name, words in COMMAND.findall(re.sub(r"#.*", "", text)):
        yield name.lower(), words.replace('"', " ").split()


def listed_files(folder):
    """The names of the test files that the CMakeLists.txt of a folder names."""
    text = (folder / "CMakeLists.txt").read_text(encoding="utf-8")
    names = set()
    for command, words in commands(text):
        names.update(Path(word).name for word in words if re.search(r"(\.pf|\btest_\w+\.py)$", word))
        if command == "add_program_test":
            names.add(f"test_{words[0]}.py")
        if "benchmarks.txt" in words:
            names.update(f"test_{name}.py" for name in (folder / "benchmarks.txt").read_text("utf-8").split())
    for _, words in LOOP.findall(re.sub(r"#.*", "", text)):
        names.update(f"test_{name}.py" for name in words.split())
    return names


def is_added(folder, tests):
    """Whether CMake comes to a folder of tests."""
    while folder != tests:
        parent = folder.parent
        if not (parent / "CMakeLists.txt").exists():
            return False
        added = [words[0] for command, words in commands((parent / "CMakeLists.txt").read_text(encoding="utf-8"))
                 if command == "add_subdirectory"]
        if folder.name not in added:
            return False
        folder = parent
    return True


def modules(root):
    """The room and the name, without `amontons_`, of each module of src/; variants for build options are one module."""
    return {(path.relative_to(root/"src").parts[0], path.name.split(".")[0].removeprefix("amontons_"))
            for path in (root/"src").glob("*/**/*.f90")}


def tested_modules(tests):
    """The file of the unit tests of each module, by its room and name."""
    return {(path.parent.name, path.stem.removeprefix("test_")): path for path in sorted(tests.rglob("*.pf"))
            if path.relative_to(tests).parts[0] != STAND_IN}


def executables(tests):
    """The .pf files of each executable of unit tests, as the folders of tests list them."""
    found = {}
    for lists in sorted(tests.rglob("CMakeLists.txt")):
        for command, words in commands(lists.read_text(encoding="utf-8")):
            if command == "add_unit_test":
                found[words[0]] = [lists.parent / word for word in words if word.endswith(".pf")]
    return found


def procedures(path):
    """Yields line, name, lines and whether it is a test of each procedure of a file, those inside of it included."""
    begun, is_test = [], False
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        code = line.strip()
        for _, _, lines, _ in begun:
            lines.append(code)
        if re.match(r"@test\b", code, re.IGNORECASE):
            is_test = True
        elif END.match(code):
            if begun:
                yield begun.pop()
        elif match := BEGIN.match(code):
            begun.append((number, match[2].lower(), [], is_test))
            is_test = False


def assertion_faults(tests):
    """Yields file, line and text of every unit test that comes to no assertion."""
    found = [(path, *procedure) for path in sorted(tests.rglob("*")) if path.suffix in (".pf", ".f90")
             for procedure in procedures(path)]
    asking = {name for _, _, name, lines, _ in found if any(map(ASSERTION.match, lines))}
    grows = True
    while grows:
        callers = {name for _, _, name, lines, _ in found if asking.intersection(
            called.lower() for line in lines for called in re.findall(r"\bcall\s+(\w+)", line, re.IGNORECASE))}
        grows = not callers <= asking
        asking |= callers
    for path, number, name, _, is_test in found:
        if is_test and name not in asking and path.parent != tests / VERDICTS:
            yield path, number, f"the test {name} asserts nothing"


def script_faults(path):
    """Yields line and text of what keeps the tests of a Python file from being run."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    if not any(isinstance(node, ast.FunctionDef) and node.name.startswith("test") for node in ast.walk(tree)):
        yield 1, "there is no test in it"
    last = [statement for statement in tree.body if isinstance(statement, ast.If) and "__main__" in ast.dump(statement)]
    calls = [ast.unparse(node.func) for statement in last for node in ast.walk(statement) if isinstance(node, ast.Call)]
    if not {"main", "unittest.main"}.intersection(calls):
        yield 1, "it does not run its tests when it is called"


def faults(tests):
    """Yields file, line and text of every fault."""
    for path in sorted([*tests.rglob("*.pf"), *tests.rglob("test_*.py")]):
        if not (path.parent / "CMakeLists.txt").exists() or path.name not in listed_files(path.parent):
            yield path, 1, "no CMakeLists.txt of its folder names it: it is never run"
        elif not is_added(path.parent, tests):
            yield path, 1, "no add_subdirectory leads to its folder: it is never run"
        if path.suffix == ".py":
            yield from ((path, *fault) for fault in script_faults(path))
    known = modules(tests.parent)
    for (room, name), path in tested_modules(tests).items():
        if (room, name) not in known:
            yield path, 1, f"src/{room} has no module amontons_{name}: a file of unit tests is named after its module"
    yield from assertion_faults(tests)


def main(root=ROOT):
    """Prints the faults, or the modules without unit tests; returns the exit status."""
    if root == "--untested":
        for room, name in sorted(modules(ROOT).difference(tested_modules(ROOT/"tests"))):
            print(f"{room}/{name}")
        return 0
    found = list(faults(Path(root).resolve() / "tests"))
    for path, number, text in found:
        print(f"{path.relative_to(Path(root).resolve())}:{number}: {text}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:2]))
