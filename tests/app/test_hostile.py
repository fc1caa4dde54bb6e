#!/usr/bin/env python3
"""Files that no engineer writes: far too long, of other programs, of other encodings, or announcing what they have not.

Each is refused within seconds and a bounded memory, with one sentence for each fault, and nothing is written.
"""
import os
import struct
import subprocess
import threading
import unittest

from harness import HAS_SANITIZER, PROGRAM, SOUND, ProgramTest

MANY = 10**6
ANNOUNCED = (10**7, 2**31 - 1, 2**63 - 1, 10**18, 10**30)
SECONDS = 10
MEGABYTES = 2000  # of addresses, which is more than what is held
LIMITS = [f"--cpu={6*SECONDS if HAS_SANITIZER else SECONDS}", *([] if HAS_SANITIZER else [f"--as={MEGABYTES*10**6}"])]


def on_mesh(file):
    """A deck on a mesh file."""
    return SOUND.replace("size = 4.0, 2.0  cells = 8, 4", f"kind = 'file'  file = '{file}'")


class HostileTest(ProgramTest):
    """Runs the program under a limit on processor time and memory."""

    def refuse(self, name, content, *messages, arguments=None, status=1):
        """Checks that a file is refused with messages, which stand behind its name."""
        if content is not None:
            data = content.encode("utf-8") if isinstance(content, str) else content
            (self.directory / name).write_bytes(data)
        before = self.files()
        run = subprocess.run(["prlimit", *LIMITS, PROGRAM, "--output", "results", *(arguments or [name])],
                             cwd=self.directory, capture_output=True, encoding="utf-8", errors="replace",
                             stdin=subprocess.DEVNULL, timeout=self.timeout, check=False)
        found = run.stderr
        self.assertEqual((run.returncode, run.stdout), (status, ""), f"{name}: {found[:500]}")
        self.assertEqual(self.files(), before, name)
        if messages:
            self.assertEqual(found, "".join(f"{name}:{message}\n" for message in messages))
        self.assertLessEqual(found.count("\n"), 1001)
        for line in found.splitlines():
            self.assertLess(len(line), 400)
        return found


class Decks(HostileTest):
    """Decks of a million lines, of lines of ten million characters, and no decks at all."""

    def test_million_comments_are_no_fault(self):
        for name, text in (("comments", "! nothing\n"*MANY + SOUND), ("blanks", "\n"*MANY + SOUND),
                           ("line", "!" + "x"*10*MANY + "\n" + SOUND),
                           ("value", SOUND.replace("ux = 0.0", "ux =" + " "*10*MANY + "0.0"))):
            run = self.run_program("--output", "results", self.write(f"{name}.nml", text))
            self.assertEqual(run.stderr, "")

    def test_million_groups(self):
        many = "10001: a deck has at most 10000 groups, found more"
        for group in ("load set = 'top' pressure = 1.0", "support set = 'right' ux = 0.0",
                      "load set = 'tpo' pressure = 1.0", "material young = 1.0 poisson = 0.1 region = 'r'"):
            self.refuse("deck.nml", SOUND + f"&{group} /\n"*MANY, many)

    def test_million_faults(self):
        # Every unknown key is held against the known ones: a million takes 5 s, in a build with checks far more.
        for text in ("&lod set = 'top' /\n"*MANY, "&mesh\n" + "color = 3\n"*(MANY//10) + "/\n",
                     "&mesh\n" + "cells = 3\n"*(MANY//10), "&load\n pressure = x\n/\n"*MANY):
            found = self.refuse("deck.nml", text)
            self.assertIn(" more faults follow\n", found)

    def test_million_values(self):
        self.refuse("deck.nml", "&mesh\n cells = " + "3,\n"*MANY + " 3 /\n",
                    "2: cells: expected 2 whole numbers, found 1000001")

    def test_lines_of_ten_million_characters(self):
        for text, message in ((SOUND.replace("left", "l"*10*MANY), "3: set: expected a text of at most 4096 "),
                              (SOUND.replace("100.0", "1"*10*MANY), "2: young: expected a number, found 111"),
                              (SOUND.replace("young", "y"*10*MANY), "2: unknown key 'yyyyyy"),
                              ("&" + "m"*10*MANY, "1: &mmm")):
            self.assertTrue(self.refuse("deck.nml", text).startswith(f"deck.nml:{message}"))

    def test_nests_and_repetitions(self):
        for text in ("&"*10**5, "/"*10**5, "'"*10**5, "&mesh cells" + "("*10**5 + " = 1 /", "&mesh &mesh &mesh / / /",
                     "&mesh " + "cells(1)"*10**4 + " = 1 /", "&mesh cells(1:2:3)%x(4) = 1, 2 /\n" + SOUND):
            self.refuse("deck.nml", text)

    def test_cells_beyond_all_memory(self):
        for cells, message in (("60000, 60000", "rectangle: more nodes than their numbers allow"),
                               ("2000000000, 2000000000", "rectangle: more nodes than their numbers allow"),
                               ("8, 4  refine = 20", "refined 20 times: more nodes than their numbers"),
                               ("0, 4", "cells must be at least 1, found 0"),
                               ("-8, 4", "cells must be at least 1, found -8"),
                               ("2147483648, 4", "cells: expected a whole number of at most 2147483647, found "),
                               ("1000000000*3", "cells: expected 2 whole numbers, found 1000000000")):
            found = self.refuse("deck.nml", SOUND.replace("8, 4", cells))
            self.assertTrue(found.startswith(f"deck.nml:1: {message}"), found)

    @unittest.skipIf(HAS_SANITIZER, "this build has no limit on memory")
    def test_cells_beyond_the_memory_there_is(self):
        for cells in ("5000, 5000", "100000, 1000", "30000000, 1", "3000, 3000  element = 'tri6'"):
            found = self.refuse("deck.nml", SOUND.replace("8, 4", cells), status=3)
            self.assertRegex(found, r"^deck\.nml:1: rectangle: not enough memory: \d+ nodes need at least \d+ "
                             r"MB, and \d+ MB are available\n$")
        found = self.refuse("deck.nml", SOUND.replace("8, 4", "8, 4  refine = 10"), status=3)
        self.assertRegex(found, r"^deck\.nml:1: refined 10 times: not enough memory: \d+ nodes need at least \d+ "
                         r"MB, and \d+ MB are available\n$")

    def test_numerals(self):
        for word in ("1d400", "1e400", "1e-400", "-1d-400"):
            self.refuse("deck.nml", SOUND.replace("100.0", word),
                        f"2: young: expected a number within double precision, found {word} (column 19)")
        for word in ("nan", "NaN", "inf", "-Infinity", "0x10", "1.0e", "1e5e5", ".", "-", "1..5", "1_8", "1.0_dp",
                     ".true.", "''", "1.0;2.0"):
            self.refuse("deck.nml", SOUND.replace("100.0", word),
                        f"2: young: expected a number, found {word} (column 19)")

    def test_encodings(self):
        for encoding in ("utf-8-sig", "latin-1", "utf-8"):
            text = "! B\u00f6schung\r\n" + SOUND.replace("\n", "\r\n")
            (self.directory / "sound.nml").write_bytes(text.encode(encoding))
            self.run_program("--output", "results", "sound.nml")
        self.refuse("deck.nml", SOUND.encode("utf-16"),
                    " expected UTF-8 text, found UTF-16; save the deck in another encoding")
        self.refuse("deck.nml", SOUND.encode("utf-16-be"), "1: expected text, found the control character 0 (column 1)")
        self.refuse("deck.nml", SOUND.encode("utf-16-le"), "1: expected text, found the control character 0 (column 2)")
        self.refuse("deck.nml", SOUND.replace("pressure", "pres\0sure"),
                    "4: expected text, found the control character 0 (column 24)")

    def test_files_of_other_programs(self):
        expected = "1: expected a group such as &mesh, found "
        for text, found in (("*HEADING\nblock\n*NODE\n1, 0., 0.\n", "'*'"), ("/PREP7\nET,1,PLANE182\n", "'/'"),
                            ("SOL 101\nCEND\nBEGIN BULK\n", "SOL"), ("DEBUT()\nMA=LIRE_MAILLAGE()\n", "DEBUT"),
                            ('{"mesh": {"size": [4, 2]}}\n', "{"), ('<?xml version="1.0"?>\n<deck/>\n', "<?xml"),
                            ("mesh:\n  size: [4, 2]\n", "mesh:"), ("[mesh]\nsize = [4.0, 2.0]\n", "[mesh]")):
            self.refuse("deck.nml", text, f"{expected}{found} (column 1)")
        found = self.refuse("deck.nml", "&control\n calculation = 'scf'\n/\n")
        self.assertIn("unknown group &control", found)
        for content in (b"\x7fELF\x02\x01\x01" + bytes(100), b"\x89PNG\r\n\x1a\n" + bytes(100), bytes(1000)):
            self.assertIn("expected text, found the control character", self.refuse("deck.nml", content))


class Places(HostileTest):
    """Names that stand for no plain file."""

    def test_devices_and_links(self):
        large = " cannot read this file: it is larger than 256 MB"
        for name, message in (("/dev/zero", large), ("/dev/full", large), ("/dev/null", " this file is empty"),
                              ("/tmp", " cannot read this file: Is a directory")):
            self.refuse(name, None, message)
            reduced = self.refuse(name, None, arguments=["--reduced", name])
            self.assertRegex(reduced, "this file is empty, or no plain file|cannot read this file: Is a directory")
        (self.directory / "loop").symlink_to("loop")
        self.refuse("loop", None, " cannot read this file: Too many levels of symbolic links")
        for file in ("/dev/zero", "/dev/null", "/dev/urandom"):
            self.refuse("deck.nml", on_mesh(file), f"1: {file}: this file is empty, or no plain file")

    def test_pipes(self):
        os.mkfifo(self.directory / "pipe")
        self.refuse("pipe", None, " this file is empty")
        # What is written while the program waits for it is read.
        writer = threading.Thread(target=lambda: (self.directory / "pipe").write_text(SOUND, encoding="utf-8"))
        writer.start()
        self.run_program("--quiet", "--output", "results", "pipe")
        writer.join()
        self.refuse("deck.nml", on_mesh("pipe"), f"1: {self.directory}/pipe: this file is empty, or no plain file")


class Meshes(HostileTest):
    """Meshes that announce far more than they have, and reduced problems that do."""

    def refuse_mesh(self, name, content):
        """Checks that a mesh is refused in one line that names a place in it."""
        data = content.encode("utf-8") if isinstance(content, str) else content
        (self.directory / name).write_bytes(data)
        found = self.refuse("deck.nml", on_mesh(name))
        self.assertRegex(found, rf"^deck\.nml:1: {self.directory}/{name}:(\d+:)? .*(announced, but the file ends after "
                         r"\d+ more bytes|out of range|than a file of this size can define)( \(byte \d+\))?\n$")

    def test_gmsh_2(self):
        head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n"
        triangle = "$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements\n"
        points = "".join(f"{i} {i % 3} {i//3} 0\n" for i in range(1, 11))
        records = b"".join(struct.pack("<iddd", i, i % 3, i//3, 0) for i in range(1, 11))
        for n in ANNOUNCED:
            self.refuse_mesh("nodes.msh", f"{head}{n}\n{points}$EndNodes\n{triangle}")
            self.refuse_mesh("cells.msh", f"{head}10\n{points}$EndNodes\n"
                             + triangle.replace("\n1\n", f"\n{n}\n"))
            self.refuse_mesh("bytes.msh", b"$MeshFormat\n2.2 1 8\n" + struct.pack("<i", 1)
                             + b"\n$EndMeshFormat\n$Nodes\n" + str(n).encode() + b"\n" + records + b"\n$EndNodes\n")

    def test_gmsh_4(self):
        numbers = "".join(f"{i}\n" for i in range(1, 11))
        points = "".join(f"{i % 3} {i//3} 0\n" for i in range(1, 11))
        for n in ANNOUNCED:
            self.refuse_mesh("nodes.msh", f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {n} 1 {n}\n2 1 0 {n}\n"
                             f"{numbers}{points}$EndNodes\n$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n")
            self.refuse_mesh("cells.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 10 1 10\n2 1 0 10\n"
                             f"{numbers}{points}$EndNodes\n$Elements\n1 {n} 1 {n}\n2 1 2 {n}\n1 1 2 3\n$EndElements\n")
            if n < 2**63:
                head = b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n"
                self.refuse_mesh("bytes.msh", head + b"$Nodes\n" + struct.pack("<qqqq", 1, n, 1, n)
                                 + struct.pack("<iiiq", 2, 1, 0, n) + bytes(320) + b"\n$EndNodes\n")
                self.refuse_mesh("entities.msh", head + b"$Entities\n" + struct.pack("<qqqq", n, n, n, n)
                                 + b"\n$EndEntities\n")

    def test_abaqus(self):
        block = "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 0., 1.\n*ELEMENT, TYPE=CPE3, ELSET=A\n1, 1, 2, 3\n"
        for n in ANNOUNCED:
            self.refuse_mesh("range.inp", block + f"*NSET, NSET=left, GENERATE\n1, {n}, 1\n")
        # A number is no announcement: nodes may have any.
        (self.directory / "far.inp").write_text(block.replace("3", "2147483647", 1).replace(" 3\n", " 2147483647\n"))
        self.refuse("deck.nml", on_mesh("far.inp"), *(f"{line}: the mesh has no set '{name}'; it has no sets at all: "
                                                      "name its boundaries in the mesh file, in Gmsh as physical curves"
                                                      for line, name in ((3, "left"), (4, "top"), (5, "bottom"))))

    def test_reduced_problems(self):
        for n in ANNOUNCED:
            found = self.refuse("problem.dat", f"2\n{n}\n0\n4\n4\n", arguments=["--reduced", "problem.dat"])
            self.assertRegex(found, r"^problem\.dat:2: (\d+ contacts are announced, but the file ends after \d+ more "
                             r"bytes|expected the number of contacts, found '\d+', which is out of range)\n$")


if __name__ == "__main__":
    unittest.main()
