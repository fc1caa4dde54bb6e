"""Makes small changes of the sources one after the other, and tells which of them no test notices.

Usage: mutants.py [--list | --random COUNT SEED] [WORD...]; see scripts/mutants.sh.

The changes are made in a copy, build/mutants/tree, that keeps its own debug build: a change costs the compilation of
one file. The tests that know most of a module run first, for all changes: those of the .pf files that use it or,
where none does, the modules that use it. What they do not notice meets all unit tests and some tests of the program,
until one fails. Verdicts are kept, with the state of sources and tests that they hold for.
"""
import hashlib
import json
import random
import re
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from check_sources import split_comment
from check_tests import executables

ROOT = Path(__file__).resolve().parents[2]
LIST = Path(__file__).with_name("mutants.txt")
WORK = ROOT / "build/mutants"
TREE = WORK / "tree"
BUILD = TREE / "build"
RECORD = WORK / "record.json"
FOLDERS = ("bench", "cmake", "doc", "input", "python", "scripts", "src", "tests")
PROGRAM_TESTS = "^(verification_.*|program_(files|sweep|reduced|all_solutions|numbers))$"
PASSED = re.compile(r"^ OK\n \((\d+) tests?", re.MULTILINE)
# How much longer than unchanged a test may take: a change may make an iteration endless.
SLOWER, MORE_SECONDS = 5, 30
# What --random does to an expression.
OPERATORS = ((" + ", " - "), (" - ", " + "), (" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "),
             (" == ", " /= "), (" /= ", " == "), (".and.", ".or."), (".or.", ".and."), (".not. ", ""), ("max(", "min("),
             ("min(", "max("), ("abs(", "("), ("0.5_dp", "1.0_dp"), ("2.0_dp", "1.0_dp"), ("1.0_dp", "2.0_dp"),
             ("any(", "all("), ("all(", "any("), (" + 1", ""), (" - 1", ""), ("*friction", ""), ("if (", "if (.not. "))


class Misfit(Exception):
    """The list does not fit the sources."""


@dataclass
class Mutant:
    """A change: `new` in the place of `old` at an offset of a file."""
    name: str
    module: str
    path: Path
    offset: int
    old: str
    new: str

    def text(self):
        """The file with the change."""
        whole = self.path.read_text(encoding="utf-8")
        return whole[:self.offset] + self.new + whole[self.offset + len(self.old):]

    def key(self):
        """What tells it from other changes."""
        return f"{self.name} | {self.old} | {self.new}"


def sources():
    """The files of the modules, by name: a move to another folder does not matter."""
    return {path.stem: path for path in (ROOT / "src").rglob("*.f90")}


def extent(text, procedure):
    """Where a procedure begins and ends in the text of its file; `*` stands for the whole file."""
    if procedure == "*":
        return 0, len(text)
    begin = re.search(rf"^[^!'\n]*\b(?:subroutine|function) +{procedure}\b(?<!end {procedure})", text, re.MULTILINE)
    end = re.search(rf"^ *end (?:subroutine|function) {procedure}\b", text, re.MULTILINE)
    if not begin or not end:
        raise Misfit(f"there is no procedure {procedure}")
    return begin.start(), end.start()


def listed_mutants():
    """The changes of the list."""
    files, mutants, faults = sources(), [], []
    lines = LIST.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines):
        if not (match := re.match(r"(\w+) (\w+|\*): ", line)):
            continue
        old, new = (lines[number + i][2:].strip() if lines[number + i][:1] == sign else None
                    for i, sign in ((1, "-"), (2, "+")))
        try:
            if not old or new is None:
                raise Misfit("expected a line with - and one with +")
            if match[1] not in files:
                raise Misfit(f"there is no module {match[1]}")
            text = files[match[1]].read_text(encoding="utf-8")
            first, last = extent(text, match[2])
            if (count := text.count(old, first, last)) != 1:
                raise Misfit(f"'{old}' stands {count} times in {match[2]}")
            mutants.append(Mutant(line, match[1], files[match[1]], text.index(old, first), old, new))
        except Misfit as misfit:
            faults.append(f"{LIST.name}:{number + 1}: {misfit}")
    if faults:
        raise Misfit("\n".join(faults))
    return mutants


def random_mutants(count, seed):
    """Changes made up from a seed, in the executable statements of procedures that compute."""
    found = []
    for module, path in sorted(sources().items()):
        if path.relative_to(ROOT / "src").parts[0] in ("app", "base", "binding", "system", "output", "verify"):
            continue
        text = path.read_text(encoding="utf-8")
        offset = text.find("\ncontains\n") + 1
        for number, line in enumerate(text[offset:].splitlines(keepends=True), start=1 + text[:offset].count("\n")):
            code = split_comment(line)[0]
            if len(code.rstrip("\n")) == len(line.rstrip("\n")) and "::" not in code and "subroutine" not in code:
                found += [Mutant(f"{module}:{number}: {code.strip()}", module, path, offset + match.start(), old, new)
                          for old, new in OPERATORS for match in re.finditer(re.escape(old), code)]
            offset += len(line)
    return random.Random(seed).sample(found, min(count, len(found)))


def used_modules(text):
    """The modules that a source file uses."""
    return set(re.findall(r"^ *use (\w+)", text, re.MULTILINE))


def run(command, **options):
    """Runs a command; returns whether it succeeded, and what it printed. None for the status if it took too long."""
    try:
        done = subprocess.run(list(map(str, command)), capture_output=True, encoding="utf-8", errors="replace",
                              check=False, **options)
    except subprocess.TimeoutExpired:
        return None, "it took too long"
    return done.returncode, done.stdout + done.stderr


def copy_sources():
    """Makes the copy equal to the sources; files that are so already keep their times, so that nothing is rebuilt."""
    names = [ROOT / name for name in ("CMakeLists.txt", "LICENSE")]
    names += [path for folder in FOLDERS for path in (ROOT / folder).rglob("*")
              if path.is_file() and "__pycache__" not in path.parts]
    wanted = {TREE / path.relative_to(ROOT): path for path in names}
    for copy, path in wanted.items():
        content = path.read_bytes()
        if not copy.exists() or copy.read_bytes() != content:
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(content)
        copy.chmod(path.stat().st_mode)
    for copy in TREE.rglob("*"):
        if copy.is_file() and BUILD not in copy.parents and copy not in wanted:
            copy.unlink()


def state():
    """A checksum of what the verdicts depend on."""
    total = hashlib.sha256()
    for folder in ("src", "tests", "cmake"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()


class Tests:
    """The tests in the copy, and how long they take where nothing is changed."""

    def __init__(self):
        self.seconds = {}
        self.units = {}
        self.suites = {}
        self.texts = {module: path.read_text(encoding="utf-8") for module, path in sources().items()}
        self.is_changed = False

    def prepare(self, seconds):
        """Builds the copy unchanged and runs all that will be run, unless it is known how long that takes; fails where
        a test does."""
        copy_sources()
        self.require(run(["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug"]))
        self.require(run(["cmake", "--build", BUILD, "--parallel", "2"]))
        status, text = run(["ctest", "--test-dir", BUILD, "--show-only=json-v1"])
        self.require((status, text))
        for test in json.loads(text[text.index("{"):])["tests"]:
            properties = {item["name"]: item["value"] for item in test["properties"]}
            if "unit" in properties.get("LABELS", ()):
                self.units[test["name"]] = (test["command"][0], properties)
        for name, files in executables(TREE / "tests").items():
            for path in files:
                self.suites[path.stem] = (name, path.read_text(encoding="utf-8"))
        self.is_changed = bool(seconds)
        self.seconds = dict(seconds)
        if not seconds:
            for name in self.units:
                self.require((0 if self.run_unit(name) else 1, f"the unit tests {name} fail unchanged"))
            self.require((0 if self.run_program() else 1, "tests of the program fail unchanged"))
        self.is_changed = True

    @staticmethod
    def require(outcome):
        """Ends where the unchanged copy does not build or does not pass."""
        status, text = outcome
        if status != 0:
            sys.exit(f"mutants.py: {text[-3000:]}")

    def limit(self, name):
        """The seconds that a test may take."""
        return SLOWER*self.seconds[name] + MORE_SECONDS if self.is_changed else 3600

    def timed(self, name, command, **options):
        """Runs a test; returns its status and what it printed."""
        start = time.monotonic()
        outcome = run(command, timeout=self.limit(name), **options)
        if not self.is_changed:
            self.seconds[name] = time.monotonic() - start
        return outcome

    def run_unit(self, name, suite=None):
        """Whether unit tests pass: all of an executable, or those of a suite."""
        program, properties = self.units[name]
        environment = ["env", *properties.get("ENVIRONMENT", ())]
        filters = ["--filter", f"{suite}_suite."] if suite else []
        _, text = self.timed(name, [*environment, program, *filters], cwd=properties["WORKING_DIRECTORY"])
        match = PASSED.search(text)
        return bool(match) and int(match[1]) > 0

    def run_program(self):
        """Whether the tests of the program pass."""
        return self.timed("program", ["ctest", "--test-dir", BUILD, "-R", PROGRAM_TESTS, "--stop-on-failure"])[0] == 0

    def users(self, module):
        """The suites of unit tests that use a module or, where none does, the modules that use it, and so on; each with
        its executable, those named like these modules first."""
        reached = near = {module}
        while near:
            if found := [(suite, name) for suite, (name, text) in self.suites.items() if near & used_modules(text)]:
                names = {other.replace("amontons", "test") for other in near}
                return sorted(found, key=lambda user: user[0] not in names)
            near = {other for other, text in self.texts.items() if near & used_modules(text)} - reached
            reached = reached | near
        return []

    def build(self, *target):
        """Whether the copy builds, all of it or a target."""
        return run(["cmake", "--build", BUILD, "--parallel", "2", *(["--target", *target] if target else [])])[0] == 0

    def first_killer(self, module):
        """What notices the change that the copy has among the suites that use the module, or 'compiler'."""
        built = None
        for suite, name in self.users(module):
            if name != built and not self.build(name):
                return "compiler"
            built = name
            if not self.run_unit(name, suite):
                return suite
        return None

    def last_killer(self, module):
        """What notices it among all tests: those of its own executable first, then the quickest."""
        own = list(dict.fromkeys(name for _, name in self.users(module)))
        if not self.build():
            return "compiler"
        for name in own + sorted(set(self.units) - set(own), key=self.seconds.get):
            if not self.run_unit(name):
                return name
        return None if self.run_program() else "program"


def try_mutant(mutant, find_killer):
    """Tries a change with one of the two ways to find a killer; returns it and the seconds that took."""
    start = time.monotonic()
    copy = TREE / mutant.path.relative_to(ROOT)
    try:
        copy.write_text(mutant.text(), encoding="utf-8")
        killer = find_killer(mutant.module)
    finally:
        copy.write_bytes(mutant.path.read_bytes())
    return killer, time.monotonic() - start


def try_mutants(mutants):
    """Tries the changes that have no verdict yet; returns all verdicts."""
    present = state()
    record = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    verdicts = {key: value for key, value in record.items() if value["state"] == present}
    unchanged = verdicts.setdefault("unchanged", {"state": present, "seconds": {}})
    left = [mutant for mutant in mutants if mutant.key() not in verdicts]
    tests = Tests()
    if left:
        print(f"{len(left)} of {len(mutants)} changes to try; building and testing the unchanged sources", flush=True)
        tests.prepare(unchanged["seconds"])
        unchanged["seconds"] = tests.seconds
        RECORD.write_text(json.dumps(verdicts, indent=1), encoding="utf-8")
    for find_killer in (tests.first_killer, tests.last_killer):
        unnoticed = []
        for mutant in left:
            killer, seconds = try_mutant(mutant, find_killer)
            if killer is None and find_killer == tests.first_killer:
                unnoticed.append(mutant)
            else:
                verdicts[mutant.key()] = {"state": present, "killer": killer}
                RECORD.write_text(json.dumps(verdicts, indent=1), encoding="utf-8")
            label = killer or ("SURVIVED" if find_killer == tests.last_killer else "not by its own tests")
            print(f"{seconds:5.0f} s  {label:24} {mutant.name}", flush=True)
            if killer in (None, "compiler"):
                print(f"{'':9}- {mutant.old}\n{'':9}+ {mutant.new}", flush=True)
        left = unnoticed
    return [verdicts[mutant.key()]["killer"] for mutant in mutants]


def main(arguments):
    """Tries what is asked for and prints the rate; returns the exit status."""
    is_random = arguments[:1] == ["--random"]
    try:
        mutants = random_mutants(int(arguments[1]), int(arguments[2])) if is_random else listed_mutants()
    except Misfit as misfit:
        print(misfit)
        return 1
    words = arguments[3:] if is_random else [word for word in arguments if word != "--list"]
    mutants = [mutant for mutant in mutants if not words or any(word in mutant.name for word in words)]
    if "--list" in arguments:
        print(f"{len(mutants)} changes fit the sources")
        return 0
    WORK.mkdir(parents=True, exist_ok=True)
    killers = try_mutants(mutants)
    survivors = [mutant for mutant, killer in zip(mutants, killers) if killer is None]
    refused = [mutant for mutant, killer in zip(mutants, killers) if killer == "compiler"]
    n = len(mutants) - len(refused)
    print(f"\n{n - len(survivors)} of {n} changes noticed")
    for label, kind in (("survived", survivors), ("refused by the compiler", refused)):
        for mutant in kind:
            print(f"{label}: {mutant.name}")
    return 1 if survivors or refused and not is_random else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
