"""Spoiled input for fuzz.py: the seeds of each format, and what is changed in them, the same in every run."""

import pathlib
import random
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
LARGEST_SEED = 30000
NUMBERS = (b"0", b"-1", b"1", b"2", b"7", b"127", b"255", b"65536", b"2147483647", b"2147483648", b"-2147483648",
           b"4294967297", b"99999999999999999999", b"1e308", b"1e-308", b"4.9e-324", b"1e999", b"-0.0", b"nan", b"inf",
           b"-infinity", b"0.5", b"0.4999999", b"3", b"1.e", b"+", b"1e5", b"1d0", b"1e", b".", b"0x10", b"1,5",
           b"1e12", b"1e-12", b"1e30", b"1e-30", b"1.0e+0000000000000000000001", b"3*1", b"-3*1", b"1000000000*1")
PIECES = (b"/", b"&", b"'", b'"', b"!", b",", b"=", b"\n", b"\r\n", b"\r", b"\x00", b"\xff\xfe", b"\xc3", b"&load ",
          b"&end\n", b" ", b"$", b"*", b"3*", b"(1)", b"(2147483648)", b"\t", b"-", b"$End", b"$Nodes\n", b"*NODE\n",
          b"#", b";", b" " * 3000, b"x" * 3000, b"''", b"%s%n", b"../", b"/dev/zero", b"/dev/null", b".", b"~")
WHOLE_NUMBERS = (0, 1, -1, 2, 3, 4, 7, 15, 16, 127, 2**16, 2**31 - 1, -2**31, 2**30)
BYTES_OF_REALS = tuple(bytes.fromhex(text) for text in (
    "000000000000f07f", "000000000000f8ff", "ffffffffffffef7f", "0100000000000000", "0000000000000080",
    "000000000000f03f", "00000000000000c0"))
NUMBER = re.compile(rb"[-+]?(\d+(\.\d*)?|\.\d+)([eEdD][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_$*][A-Za-z_0-9]*|'[^'\n]*'|\"[^\"\n]*\"")
GROUP = re.compile(rb"&\w+[^/&]*/\n?")

BODY = (b"&mesh size = 4.0, 2.0  cells = 6, 3 /\n&material young = 1000.0  poisson = 0.3 /\n"
        b"&support set = 'right'  ux = 0.0 /\n&load set = 'top'  pressure = 1.0 /\n")
SOLID = (b"&mesh kind = 'box'  size = 2.0, 2.0, 1.0  cells = 3, 3, 2 /\n&material young = 1000.0  poisson = 0.3 /\n"
         b"&support set = 'top'  ux = 0.0  uy = 0.0  uz = -0.01 /\n")
TABLES = {
    "line": b"# x, y of a polyline\n-1.0, 0.1\n1.0, 0.0\n2.5 0.0\n5.0, 0.3\n",
    "friction_table": b"# length, coefficient\n0.0, 0.1\n1.5, 0.5\n4.0, 0.3\n",
    "gap_table": b"length; gap\n0.0; 0.0\n1.5; -0.001\n4.0; 0.002\n",
    "slip_bound_table": b"length stress\n0.0 0.1\n1.5 0.5\n4.0 0.3\n",
    "file": b"solid roof\n" + b"".join(
        b"facet normal 0 0 1\n outer loop\n  vertex -1 -1 0\n  vertex %s\n  vertex %s\n endloop\nendfacet\n" % ends
        for ends in ((b"3 -1 -0.1", b"3 3 0.0"), (b"3 3 0.0", b"-1 3 -2e-1"))) + b"endsolid roof\n",
}


def body_with_table(key, name):
    """A deck around a table."""
    shape = {"line": " obstacle = 'polyline'", "file": " obstacle = 'surface'"}.get(key, "")
    body = SOLID if key == "file" else BODY
    return body + b"&contact set = 'bottom' %s  %s = '%s' /\n" % (shape.encode(), key.encode(), name.encode())


def files_of(folders, ending):
    """What stands in the smaller files of some folders, by whether they are sound."""
    found = {True: [], False: []}
    for folder in folders:
        for path in sorted((ROOT / folder).glob(f"*{ending}")):
            if path.stat().st_size < LARGEST_SEED:
                found[folder.rpartition("/")[2] not in ("bad", "troubles")].append(path.read_bytes())
    return found


def small(text):
    """A deck whose mesh is small and whose name is that of its file, so that a run takes milliseconds."""
    text = re.sub(rb"(&case\b[^/]*?)\bname *= *'[^']*'", rb"\1", text)
    text = re.sub(rb"file *= *'(?=\w)", b"file = '" + str(ROOT / "input").encode() + b"/", text)
    text = re.sub(rb"count *= *\d+", b"count = 3", text)
    return re.sub(rb"cells *= *\d+ *, *\d+", b"cells = 6, 3", text)


def is_gmsh(version, mode):
    """Whether a mesh is of a version and mode (0 text, 1 binary), or of none at all."""
    def judge(content):
        head = re.match(rb"\$MeshFormat\s+(\S+) (\d)", content)
        return head is None or (head[1] == version and head[2] == mode)
    return judge


GMSH = {"gmsh_2": is_gmsh(b"2.2", b"0"), "gmsh_2_binary": is_gmsh(b"2.2", b"1"),
        "gmsh_4": is_gmsh(b"4.1", b"0"), "gmsh_4_binary": is_gmsh(b"4.1", b"1")}
FORMATS = ("deck", *GMSH, "abaqus", "table", "reduced", "command")


def seeds_of(kind):
    """The sound and the refused seeds of a format that has its seeds in the repository."""
    if kind == "deck":
        found = files_of(("input", "tests/verification/decks", "tests/bad", "tests/troubles"), ".nml")
        return [[small(text) for text in found[is_sound]] for is_sound in (True, False)]
    if kind in GMSH:
        found = files_of(("tests/meshes", "tests/meshes/bad"), ".msh")
        return [list(filter(GMSH[kind], found[is_sound])) for is_sound in (True, False)]
    if kind == "abaqus":
        found = files_of(("tests/meshes", "tests/meshes/bad"), ".inp")
    elif kind == "reduced":
        found = files_of(("tests/reduced", "tests/reduced/bad"), ".dat")
    else:
        found = {True: list(TABLES.values()), False: []}
    return [found[True], found[False]]


class Mutator:
    """Changes seeds: numbers for others, words, lines and groups moved, doubled and left out, files spliced, bytes."""

    def __init__(self, kind, sound, refused):
        self.kind, self.sound, self.refused = kind, sound, refused
        self.is_binary = "binary" in kind
        self.words = sorted({word for seed in sound + refused for word in WORD.findall(seed)}) or [b"x"]
        self.groups = sorted({group for seed in sound for group in GROUP.findall(seed)})
        self.changes = [self.number, self.number, self.number, self.swap_numbers, self.word, self.swap_words, self.line,
                        self.line, self.byte, self.piece, self.cut_out, self.double, self.splice, self.end]
        if kind == "deck":
            self.changes += [self.group, self.group, self.group, self.word]
        if self.is_binary:
            self.changes += [self.binary, self.binary, self.binary, self.binary, self.byte, self.byte]

    def mutation(self, k):
        """The mutation with this number: of a sound file in three cases of four."""
        dice = random.Random(f"{self.kind} {k}")
        data = bytearray(dice.choice(self.refused if self.refused and dice.random() < 0.25 else self.sound))
        for _ in range(dice.choice((1, 1, 1, 1, 2, 2, 3, 6))):
            dice.choice(self.changes)(data, dice)
        return bytes(data)

    @staticmethod
    def stretch(data, dice):
        """A place, and where a short stretch behind it ends."""
        at = dice.randrange(len(data) + 1)
        return at, min(len(data), at + dice.choice((1, 1, 2, 4, 8, 30, 200)))

    @staticmethod
    def found(pattern, data, dice):
        """A match of a pattern, looked for behind a random place and then from the beginning."""
        return pattern.search(data, dice.randrange(len(data) + 1)) or pattern.search(data)

    def number(self, data, dice):
        """Another number in the place of one."""
        if match := self.found(NUMBER, data, dice):
            old = match[0]
            new = dice.choice(NUMBERS)
            if dice.random() < 0.3 and old.isdigit():
                new = b"%d" % (int(old) + dice.choice((-1, 1, 2)))
            elif dice.random() < 0.1:
                new = b"-" + old
            data[match.start():match.end()] = new

    def swap(self, pattern, data, dice):
        """Two matches of a pattern change places."""
        one, two = self.found(pattern, data, dice), self.found(pattern, data, dice)
        if one and two and one.start() != two.start():
            first, second = sorted((one, two), key=lambda match: match.start())
            if first.end() <= second.start():
                old, new = second[0], first[0]
                data[second.start():second.end()] = new
                data[first.start():first.end()] = old

    def swap_numbers(self, data, dice):
        """Two numbers change places."""
        self.swap(NUMBER, data, dice)

    def swap_words(self, data, dice):
        """Two words change places."""
        self.swap(WORD, data, dice)

    def word(self, data, dice):
        """Another word of the format in the place of one, or none."""
        if match := self.found(WORD, data, dice):
            data[match.start():match.end()] = dice.choice(self.words) if dice.random() < 0.85 else b""

    def line(self, data, dice):
        """A line left out, doubled, moved, or a run of lines left out."""
        lines = bytes(data).split(b"\n")
        at, to = dice.randrange(len(lines)), dice.randrange(len(lines))
        choice = dice.randrange(4)
        if choice == 0:
            del lines[at]
        elif choice == 1:
            lines.insert(to, lines[at])
        elif choice == 2:
            lines.insert(to, lines.pop(at))
        else:
            del lines[min(at, to):max(at, to)]
        data[:] = b"\n".join(lines)

    def group(self, data, dice):
        """A group left out, doubled, or one of another deck put in its place or before it."""
        if match := self.found(GROUP, data, dice):
            other = dice.choice(self.groups)
            data[match.start():match.end()] = dice.choice((b"", match[0]*2, other, other + match[0]))

    def byte(self, data, dice):
        """A byte changed: any other, or one bit."""
        if data:
            at = dice.randrange(len(data))
            data[at] = dice.randrange(256) if dice.random() < 0.5 else data[at] ^ (1 << dice.randrange(8))

    def binary(self, data, dice):
        """A whole number of 4 or 8 bytes or a real, at any place, set to one at a limit or to its neighbor."""
        at = dice.randrange(max(1, len(data) - 8))
        width = dice.choice((4, 4, 8))
        if dice.random() < 0.3:
            data[at:at + 8] = dice.choice(BYTES_OF_REALS)
        elif dice.random() < 0.5:
            value = int.from_bytes(data[at:at + width], "little") + dice.choice((-1, 1))
            data[at:at + width] = (value % 256**width).to_bytes(width, "little")
        else:
            data[at:at + width] = (dice.choice(WHOLE_NUMBERS) % 256**width).to_bytes(width, "little")

    def piece(self, data, dice):
        """Something that means something somewhere, put in anywhere."""
        at = dice.randrange(len(data) + 1)
        data[at:at] = dice.choice(PIECES)

    def cut_out(self, data, dice):
        """A stretch left out."""
        at, to = self.stretch(data, dice)
        del data[at:to]

    def double(self, data, dice):
        """A stretch doubled."""
        at, to = self.stretch(data, dice)
        data[at:at] = data[at:to]

    def splice(self, data, dice):
        """A stretch of another file in the place of one, or the other's second half from a line on."""
        other = dice.choice(self.sound)
        if dice.random() < 0.5:
            at, to = self.stretch(data, dice)
            start, end = self.stretch(other, dice)
            data[at:to] = other[start:end]
        else:
            at, start = data.find(b"\n", dice.randrange(len(data) + 1)), other.find(b"\n", dice.randrange(len(other)))
            data[at + 1:] = other[start + 1:]

    def end(self, data, dice):
        """The end of the file cut off."""
        del data[dice.randrange(len(data) + 1):]


OPTIONS = ("--output", "--check", "--quiet", "--threads", "--reduced", "--write-reduced", "--all-solutions",
           "--reference", "--help", "--version", "--verify", "--", "-", "-h", "-q", "-o", "-t", "-x",
           "--outpu", "", " ", "=",
           "--=", "--threads=", "--output=", "--set", "--set=")
VALUES = ("out", "1", "2", "0", "-1", "64", "99999999999", "1e3", "one", "", "sound.nml", "bad.nml", "none.nml", ".",
          "/dev/null", "/dev/full", "a" * 300, "\u00fc", "contact", "mesh", "load", "out/deeper", "problem.dat", "'",
          "*", "%s")
SETTINGS = ("contact.friction=0.5", "CONTACT(1).friction=-1", "contact(2).friction=1", "mesh.cells=3", "mesh.cells=3,2",
            "solver.method=psor", "solver.method='psor", "case.title=it's / &mesh", "load.pressure=1e999", "x.y=1",
            "mesh.cells(1)=2", "contact.friction", "a.b.c=1", "(1).=", "contact(99999999999).x=1", "case.name=a\nb")


def command_line(k):
    """The command line with this number: options and values, in any order, joined or not."""
    dice = random.Random(f"command {k}")
    words = []
    for _ in range(dice.choice((0, 1, 2, 2, 3, 3, 4, 6, 12))):
        choice = dice.random()
        if choice < 0.3:
            words.append(dice.choice(OPTIONS))
        elif choice < 0.45:
            words += [dice.choice(("--output", "--threads")), dice.choice(VALUES)]
        elif choice < 0.5:
            words += ["--set", dice.choice(SETTINGS)]
        elif choice < 0.6:
            words.append(dice.choice(OPTIONS) + "=" + dice.choice(VALUES))
        elif choice < 0.8:
            words.append(dice.choice(("sound.nml", "bad.nml", "problem.dat")))
        else:
            words.append(dice.choice(VALUES))
    return words
