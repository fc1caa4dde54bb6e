"""Feeds the program with spoilt input and fails where it does anything but solve it or refuse it with a sentence.

Usage: fuzz.py PROGRAM FORMAT COUNT [FIRST]

FORMAT is deck, gmsh, abaqus or reduced. Mutation number k is the same in every run, so FIRST goes on where another run
stopped. Many files go to one command; when that dies, hangs, grows or says nothing, its files are tried one by one and
the culprits are kept in build/fuzz.
"""

import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BATCH = 25
SECONDS_EACH = 10
# What one file may take [MB]. The address sanitizer's own memory comes on top.
MEMORY_EACH = 1000
NUMBERS = ("0", "-1", "1", "2147483647", "2147483648", "99999999999999999999", "1e308", "1e-308", "1e999", "-0.0",
           "nan", "inf", "0.5", "3", "1.e", "+", "1e5")
PIECES = (b"/", b"&", b"'", b'"', b"!", b",", b"=", b"\n", b"\r\n", b"\x00", b"\xff\xfe", b"&load ", b"&end\n", b" ",
          b"$", b"*", b"3*", b"(1)", b"\t", b"-", b"$End", b"*NODE\n")


def seeds(kind):
    """Small files of a format: the sound ones, and those that are refused already."""
    folders, endings = {
        "deck": (("input", "tests/verification/decks", "tests/bad"), (".nml",)),
        "gmsh": (("tests/meshes", "tests/meshes/bad"), (".msh",)),
        "abaqus": (("tests/meshes", "tests/meshes/bad"), (".inp",)),
        "reduced": (("tests/reduced", "tests/reduced/bad"), (".dat",)),
    }[kind]
    found = {True: [], False: []}
    for folder in folders:
        for path in sorted((ROOT / folder).glob("*")):
            if path.suffix in endings and path.stat().st_size < 60000:
                found[not folder.endswith("bad")].append(path.read_bytes())
    return found[True], found[False]


def small(text):
    """A deck whose mesh is small and whose name is that of its file, so that a run takes milliseconds."""
    text = re.sub(rb"name *= *'[^']*'", b"", text)
    return re.sub(rb"cells *= *\d+ *, *\d+", b"cells = 6, 3", text)


def mutate(data, others, dice):
    """One to four changes somewhere in the data."""
    data = bytearray(data)
    for _ in range(dice.choice((1, 1, 1, 2, 2, 4))):
        at = dice.randrange(len(data) + 1)
        length = min(dice.choice((1, 1, 2, 4, 8, 30, 200)), len(data) - at)
        choice = dice.randrange(10)
        if choice == 0:
            data[at : at + length] = b""
        elif choice == 1:
            data[at:at] = data[at : at + length]
        elif choice == 2:
            data[at : at + 1] = bytes([dice.randrange(256)])
        elif choice == 3:
            data[at:at] = dice.choice(PIECES)
        elif choice == 4:
            del data[at:]
        elif choice == 5:
            other = dice.choice(others)
            start = dice.randrange(len(other) + 1)
            data[at : at + length] = other[start : start + length]
        elif choice == 6 and at + 4 <= len(data):
            data[at : at + 4] = dice.choice((0, -1, 1, 2**31 - 1, 7)).to_bytes(4, "little", signed=True)
        elif choice == 7:
            lines = bytes(data).split(b"\n")
            line = dice.randrange(len(lines))
            lines.insert(dice.randrange(len(lines) + 1), lines.pop(line) if dice.random() < 0.5 else lines[line])
            data = bytearray(b"\n".join(lines))
        else:
            numbers = list(re.finditer(rb"[-+]?\d+(\.\d*)?([eEdD][-+]?\d+)?", data))
            if numbers:
                place = dice.choice(numbers)
                data[place.start() : place.end()] = dice.choice(NUMBERS).encode()
    return bytes(data)


def spoilt(sound, refused, dice):
    """A mutation: of a sound file in two cases of three."""
    seed = dice.choice(sound if not refused or dice.random() < 2 / 3 else refused)
    return mutate(seed, sound, dice)


def deck_of(mesh):
    """A deck around a mesh file with the sets of the fixtures."""
    end = "right end" if mesh.suffix == ".msh" else "right_end"
    return (f"&mesh kind = 'file'  file = '{mesh.name}' /\n&material young = 1000.0  poisson = 0.3 /\n"
            f"&support set = '{end}'  ux = 0.0 /\n&load body_force = 0.1, -1.0 /\n"
            "&contact set = 'bottom'  friction = 0.3 /\n")


def write_case(folder, kind, number, data):
    """Writes a mutation, and returns the arguments that have the program read it."""
    if kind == "deck":
        path = folder / f"m{number}.nml"
        path.write_bytes(data)
        return [str(path)]
    if kind == "reduced":
        path = folder / f"m{number}.dat"
        path.write_bytes(data)
        return [str(path)]
    mesh = folder / f"m{number}{'.msh' if kind == 'gmsh' else '.inp'}"
    mesh.write_bytes(data)
    deck = folder / f"m{number}.nml"
    deck.write_text(deck_of(mesh))
    return [str(deck)]


def complaint(program, kind, folder, files):
    """What is wrong with the way the program takes some files; None if nothing is."""
    options = ["--quiet", "--threads", "1", "--output", str(folder / "out"), *(["--reduced"] * (kind == "reduced"))]
    process = subprocess.Popen([program, *options, *files], cwd=folder, stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        output, errors = process.communicate(timeout=SECONDS_EACH * (1 if len(files) == 1 else 3))
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return "hangs"
    if process.returncode < 0:
        return f"dies of {signal.Signals(-process.returncode).name}"
    if process.returncode not in (0, 1, 2, 3, 4):
        return f"ends with status {process.returncode}"
    if process.returncode and not errors.strip() and not output.strip():
        return f"says nothing and ends with status {process.returncode}"
    for sign in (b"ERROR: ", b"runtime error", b"Fortran runtime", b"Backtrace", b"LeakSanitizer"):
        if sign in errors:
            return f"reports {sign.decode()}"
    return None


def limited(program):
    """The program under a memory limit, unless a sanitizer, which reserves whole address spaces, is built in."""
    if b"__asan_init" in pathlib.Path(program).read_bytes():
        return program
    wrapper = pathlib.Path(tempfile.mkdtemp(prefix="fuzz_")) / "limited"
    wrapper.write_text(f"#!/bin/sh\nulimit -v {MEMORY_EACH * 1000}\nexec '{program}' \"$@\"\n")
    wrapper.chmod(0o755)
    return str(wrapper)


def main(program, kind, count, first):
    os.environ.setdefault("ASAN_OPTIONS", f"hard_rss_limit_mb={MEMORY_EACH}:allocator_may_return_null=1")
    program = limited(os.path.abspath(program))
    sound, refused = ([small(seed) if kind == "deck" else seed for seed in group] for group in seeds(kind))
    kept = ROOT / "build/fuzz"
    found = 0
    for start in range(first, first + count, BATCH):
        numbers = range(start, min(start + BATCH, first + count))
        with tempfile.TemporaryDirectory(prefix="fuzz_") as scratch:
            folder = pathlib.Path(scratch)
            files = {}
            for number in numbers:
                dice = random.Random(f"{kind} {number}")
                files[number] = write_case(folder, kind, number, spoilt(sound, refused, dice))
            if not complaint(program, kind, folder, sum(files.values(), [])):
                continue
            for number, names in files.items():
                reason = complaint(program, kind, folder, names)
                if not reason:
                    continue
                found += 1
                kept.mkdir(parents=True, exist_ok=True)
                for path in folder.glob(f"m{number}.*"):
                    shutil.copy(path, kept / f"{kind}_{path.name}")
                print(f"{kind} {number}: {reason}")
                sys.stdout.flush()
    print(f"{kind}: {count} mutations, {found} at fault")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]) if len(sys.argv) > 4 else 0))
