"""Feeds the program with spoiled input and fails where it does anything but solve it or refuse it with a sentence.

Usage: fuzz.py PROGRAM FORMAT COUNT [FIRST]

FORMAT is one of those in spoiled_files.py. Mutation number k is the same in every run, so FIRST goes on where another
run stopped. Many files go to one command, which checks them; those in order go to a second one, which solves them.
Where the program dies, hangs, grows, says nothing, says that all is well when it is not, leaves a torn or surplus file
or writes a number that is none, the culprit is looked for, made as small as it still does that, kept in build/fuzz and
printed.
"""

import array
import base64
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import spoiled_files

ROOT = pathlib.Path(__file__).resolve().parents[2]
BATCH = 200
# Of processor time; on the clock it may be ten times as many, where other work takes turns.
SECONDS_EACH = 10
SECONDS_A_BATCH = 120
# What one file may take [MB]. The address sanitizer's own memory comes on top.
MEMORY_EACH = 1000
# The system's and OpenBLAS's own address space [MB], which nothing is in.
ADDRESSES = 600
SIGNS = (b"ERROR: ", b"runtime error", b"Fortran runtime", b"Backtrace", b"Sanitizer", b"Error termination",
         b"terminate called", b"munmap_chunk", b"free()", b"malloc")
SIZES = re.compile(rb"(\d+) (nodes|contact points|contacts|cases)")
# What a case may have at the most to be solved here: a spoiled number may ask for work that takes hours in all honesty.
LARGEST = {b"nodes": 2000, b"contact points": 100, b"contacts": 100, b"cases": 300}
# Solving takes most of the time: of the formats that only bring a mesh or a table, one batch in four will do.
SOLVED_BATCHES = {"deck": 2, "reduced": 1}
PATIENT = re.compile(rb"max_iterations\W*\d{5}")
UNFINISHED = (".tmp", ".part", ".checkpoint")
# What gfortran makes of the bounds of an array that is not allocated yet when it is assigned: looked at, never used.
# The contact methods have no other integers of 8 bytes that could overflow.
# A warning follows the line of its file.
WARNING = re.compile(rb"m\d+: warning: |\d+ decks: ")
# What a run of several decks ends with.
TALLY = re.compile(rb"\d+ decks: ")
UNUSED_BOUNDS = re.compile(rb"[^\n]*(/src/contact/[^\n]*: signed integer overflow: [^\n]*'integer\(kind=8\)'"
                           rb"|runtime error: signed integer overflow: -9223372036854775808 - 1 cannot[^\n]*)\n")
NO_NUMBER = re.compile(rb"(?<![\w'.])[-+]?(nan|inf|infinity)(?![\w'.-])", re.IGNORECASE)


class Program:
    """The program under test, under a memory limit."""

    def __init__(self, path):
        self.path = os.path.abspath(path)
        self.is_sanitized = b"__asan_init" in pathlib.Path(path).read_bytes()
        self.environment = dict(os.environ, OMP_NUM_THREADS="1", ASAN_OPTIONS=":".join((
            f"hard_rss_limit_mb={MEMORY_EACH}", "allocator_may_return_null=1", "quarantine_size_mb=16")))

    def run(self, folder, words, seconds, stdin=subprocess.DEVNULL):
        """Runs it: what is wrong with its end, or None; and its status, output and errors."""
        # A sanitizer reserves whole address spaces.
        memory = [] if self.is_sanitized else [f"--as={(MEMORY_EACH + ADDRESSES)*1000000}"]
        command = ["prlimit", f"--cpu={seconds}:{seconds + 5}", *memory, self.path, *words]
        with subprocess.Popen(command, cwd=folder, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              env=self.environment) as process:
            try:
                output, errors = process.communicate(timeout=10*seconds)
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()
                return "hangs", None, b"", b""
        status = process.returncode
        if status == -signal.SIGXCPU:
            return "hangs", None, b"", b""
        errors = UNUSED_BOUNDS.sub(b"", errors)
        for sign in SIGNS:
            if sign in errors:
                return f"reports '{sign.decode()}'", status, output, errors
        if status < 0:
            return f"dies of {signal.Signals(-status).name}", status, output, errors
        if status not in (0, 1, 2, 3, 4):
            return f"ends with status {status}", status, output, errors
        return None, status, output, errors


def deck_of(mesh, data):
    """A deck around a mesh file with the sets of the fixtures."""
    end = next((name for name in ("right end", "right_end") if name.encode() in data), "right")
    return (f"&mesh kind = 'file'  file = '{mesh.name}' /\n&material young = 1000.0  poisson = 0.3 /\n"
            f"&support set = '{end}'  ux = 0.0 /\n&load body_force = 0.1, -1.0 /\n"
            "&contact set = 'bottom'  friction = 0.3 /\n")


def write_case(folder, kind, number, data):
    """Writes a mutation, and returns the name of the file that has the program read it."""
    stem = f"m{number}"
    deck = folder / f"{stem}.nml"
    if kind == "deck":
        deck.write_bytes(data)
    elif kind == "reduced":
        deck = folder / f"{stem}.dat"
        deck.write_bytes(data)
    elif kind == "table":
        (folder / f"{stem}.csv").write_bytes(data)
        keys = list(spoiled_files.TABLES)
        deck.write_bytes(spoiled_files.body_with_table(keys[number % len(keys)], f"{stem}.csv"))
    else:
        mesh = folder / f"{stem}{'.inp' if kind == 'abaqus' else '.msh'}"
        mesh.write_bytes(data)
        deck.write_text(deck_of(mesh, data))
    return deck.name


def numbers_told(text):
    """The numbers of the cases that lines of output begin with; None if a line begins with none."""
    matches = [re.match(rb"m(\d+)[.:]", line) for line in text.splitlines() if not TALLY.match(line)]
    return {int(match[1]) for match in matches} if all(matches) else None


def is_status_explained(status, output, errors):
    """Whether the exit status is what the program said."""
    return (status == 0) == (not errors and b" NOT " not in output)


def bad_vtu(content):
    """Whether a number of a VTU file is not finite."""
    arrays = re.findall(rb'<DataArray type="Float64"[^>]*>([^<]*)<', content)
    return not all(all(map(math.isfinite, array.array("d", base64.b64decode(text)[8:]))) for text in arrays)


def bad_file(path, status):
    """What is wrong with a file that the program left, or None."""
    content = path.read_bytes()
    ending = path.name.partition(".")[2]
    if not content:
        return f"leaves an empty {ending}"
    if ending.endswith(UNFINISHED):
        return f"leaves the unfinished file .{ending}"
    if ending.endswith("vtu"):
        return f"writes no number into {ending}" if bad_vtu(content) else None
    if ending == "summary.json":
        # Python reads NaN and Infinity, which JSON has not.
        found = []
        try:
            summary = json.loads(content, parse_constant=found.append)
        except ValueError:
            return "writes a summary that is no JSON"
        if found:
            return "writes no number into the summary"
        # A sweep in which no case has an equilibrium has nothing to certify, nor has a history without a step.
        certified = (summary["certificate"]["passed"] if "certificate" in summary
                     else "sweep" in summary and not summary["sweep"]["solved"])
        if status == 0 and not (summary["converged"] and certified):
            return "ends with status 0 although the summary says that it is not solved"
    # Above the second empty line of a listing stand the words of the deck.
    elif (ending.endswith("csv") and NO_NUMBER.search(content.partition(b"\n")[2])
          or ending == "lst" and NO_NUMBER.search(content.split(b"\n\n", 2)[2])):
        return f"writes no number into {ending}"
    return None


class Fuzzer:
    """Runs mutations of a format through the program."""

    def __init__(self, program, kind):
        self.program, self.kind = Program(program), kind
        self.n_solved = self.n_refused = 0
        seeds = None if kind == "command" else spoiled_files.seeds_of(kind)
        if seeds and not seeds[0]:
            raise SystemExit(f"{kind}: no seeds")
        self.mutator = spoiled_files.Mutator(kind, *seeds) if seeds else None

    def mutation(self, k):
        """The mutation with this number."""
        return spoiled_files.command_line(k) if self.kind == "command" else self.mutator.mutation(k)

    def complaint(self, cases, seconds):
        """What is wrong with the way the program takes some mutations, given by their numbers; None if nothing is."""
        with tempfile.TemporaryDirectory(prefix="fuzz_") as scratch:
            folder = pathlib.Path(scratch)
            if self.kind == "command":
                return self.complaint_of_command(folder, *cases.values())
            files = {k: write_case(folder, self.kind, k, data) for k, data in cases.items()}
            before = len(os.listdir(folder))
            words = ["--reduced"]*(self.kind == "reduced") + ["--threads", "1", "--output", "out"]
            reason, status, output, errors = self.program.run(folder, [*words, "--check", *files.values()], seconds)
            if reason:
                return reason
            refused = numbers_told(errors)
            if refused is None:
                return "says something that names no file"
            in_order = [line for line in output.splitlines() if not WARNING.match(line)]
            if len(in_order) + len(refused) != len(files):
                return "says nothing of a file, or too much"
            if not is_status_explained(status, output, errors):
                return f"ends its check with the unexplained status {status}"
            if len(os.listdir(folder)) != before:
                return "leaves a file although it only checks"
            self.n_refused += len(refused)
            if min(files) // BATCH % SOLVED_BATCHES.get(self.kind, 4):
                return None
            chosen = [k for k in files if k not in refused and self.is_worth(k, output, cases[k])]
            return self.complaint_of_solving(folder, words, {k: files[k] for k in chosen}, seconds) if chosen else None

    def is_worth(self, k, output, data):
        """Whether a case that is in order is small enough to be solved."""
        line = re.search(rb"^m%d: deck OK; .*" % k, output, re.MULTILINE)
        return (line is not None and not PATIENT.search(data)
                and all(int(match[1]) <= LARGEST[match[2]] for match in SIZES.finditer(line[0])))

    def complaint_of_solving(self, folder, words, files, seconds):
        """What is wrong with the way the program solves cases that are in order; None if nothing is."""
        options = [[], ["--write-reduced"], [], ["--all-solutions"]][min(files) // (4*BATCH) % 4]
        reason, status, output, errors = self.program.run(folder, [*words, *options, *files.values()], seconds)
        if reason:
            return f"solving, {reason}"
        solved, failed = numbers_told(output), numbers_told(errors)
        if solved is None or failed is None:
            return "solving, says something that names no file"
        if solved | failed != set(files):
            return "solving, says nothing of a file"
        if not is_status_explained(status, output, errors):
            return f"solving, ends with the unexplained status {status}"
        self.n_solved += len(solved)
        # That there is no equilibrium is an answer with files, as is a history whose first step does not converge.
        free = [line for line in errors.splitlines() if b": no equilibrium" in line or line.endswith(b" at step 0")]
        answered = solved | numbers_told(b"\n".join(free))
        for path in sorted((folder / "out").iterdir()) if solved else []:
            case = re.match(r"m(\d+)\.", path.name)
            if case and int(case[1]) not in answered:
                return "solving, leaves files of a case that it refused"
            if reason := bad_file(path, status):
                return f"solving, {reason}"
        return None

    def complaint_of_command(self, folder, words):
        """What is wrong with the way the program takes a command line; None if nothing is."""
        (folder / "sound.nml").write_bytes(spoiled_files.BODY + b"&contact set = 'bottom'  friction = 0.3 /\n")
        (folder / "bad.nml").write_text("&mesh /\n")
        shutil.copy(ROOT / "tests/reduced/dense.dat", folder / "problem.dat")
        before = len(os.listdir(folder))
        with open(folder / "sound.nml", "rb") as deck:
            reason, status, output, errors = self.program.run(folder, words, SECONDS_EACH, deck)
        if reason:
            return reason
        if not is_status_explained(status, output, errors):
            return f"ends with the unexplained status {status}"
        if errors.startswith(b"amontons: ") and len(os.listdir(folder)) != before:
            return "leaves a file although it refuses the command line"
        return None

    def culprits(self, cases):
        """The mutations of a batch that the program takes badly, with what is wrong."""
        reason = self.complaint(cases, SECONDS_EACH if len(cases) == 1 else SECONDS_A_BATCH)
        if not reason or len(cases) == 1:
            return [(reason, k, cases[k]) for k in cases if reason]
        numbers = list(cases)
        halves = numbers[:len(numbers)//2], numbers[len(numbers)//2:]
        found = [culprit for half in halves for culprit in self.culprits({k: cases[k] for k in half})]
        # Many together may take long on a busy machine; that none of them does alone is enough.
        if found or "hangs" in reason:
            return found
        return [(f"together with {len(cases) - 1} others {reason}", numbers[0], cases[numbers[0]])]

    def smaller(self, reason, k, data):
        """The mutation without what does not matter to the complaint."""
        if "hangs" in reason or "together" in reason:
            return data
        attempts, width = 300, len(data)//2
        while width > 0 and attempts > 0:
            at = 0
            while at < len(data) and attempts > 0:
                less = data[:at] + data[at + width:]
                attempts -= 1
                if len(less) > 0 and self.complaint({k: less}, SECONDS_EACH) == reason:
                    data = less
                else:
                    at += width
            width //= 2
        return data

    def report(self, reason, k, data):
        """Keeps a culprit, as it was and made small, and prints it."""
        small = self.smaller(reason, k, data)
        kept = ROOT / "build/fuzz"
        kept.mkdir(parents=True, exist_ok=True)
        for name, content in ((f"{self.kind}_{k}", data), (f"{self.kind}_{k}.small", small)):
            (kept / name).write_bytes(repr(content).encode() if self.kind == "command" else content)
        print(f"{self.kind} {k}: {reason}; build/fuzz/{self.kind}_{k}, of which there matters\n  {small[:600]!r}")
        sys.stdout.flush()

    def run(self, count, first):
        """Runs some mutations; returns how many are taken badly."""
        n_found = 0
        batch = 1 if self.kind == "command" else BATCH
        for start in range(first, first + count, batch):
            cases = {k: self.mutation(k) for k in range(start, min(start + batch, first + count))}
            for culprit in self.culprits(cases):
                n_found += 1
                self.report(*culprit)
        print(f"{self.kind}: {count} mutations from {first} on, {self.n_refused} refused, {self.n_solved} solved, "
              f"{n_found} at fault")
        return n_found


if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[2] not in spoiled_files.FORMATS:
        sys.exit(__doc__)
    sys.exit(1 if Fuzzer(sys.argv[1], sys.argv[2]).run(*map(int, (sys.argv[3:] + ["0"])[:2])) else 0)
