"""What the tests of --verify share: results in a directory, and changes of them that their manifest does not show."""
import re
import struct
import zlib
from pathlib import Path

from harness import ProgramTest, change_array, read_vtu

ROOT = Path(__file__).resolve().parents[2]
PUSH = "load set = 'right'  traction = -1.5, 0.3"  # part of the floor sticks, part slides, part opens
MEMBER = re.compile(r'    \{"name": "([^"]*)", "bytes": \d+, "checksum": \d+\}')
CHECKSUM = '  "checksum": '


REVERSED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


def checksum(content):
    """The number that cksum prints first: that of zlib with the bits of each byte in reverse order, the length behind
    the content."""
    length = len(content).to_bytes((len(content).bit_length() + 7)//8, "little")
    return int(f"{zlib.crc32((content + length).translate(REVERSED), 0xFFFFFFFF):032b}"[::-1], 2)


class Verification(ProgramTest):
    """Cases in the directory `results`."""

    def setUp(self):
        super().setUp()
        self.results = self.directory / "results"

    def solve_into_results(self, *decks, status=0):
        """Solves decks, given by their texts or paths."""
        names = [deck if isinstance(deck, Path) else self.write(f"case_{number}.nml", deck)
                 for number, deck in enumerate(decks)]
        self.run_program("--quiet", "--output", "results", *names, status=status)

    def verify(self, status=0):
        """Verifies the results; what was said on standard error, or on standard output if all is well."""
        run = self.run_program("--verify", "results", status=status)
        return run.stdout if status == 0 else run.stderr

    def renew_manifest(self, name):
        """Gives a case the manifest that its files have now."""
        path = self.results / f"{name}.summary.json"

        def renewed(match):
            file = self.results / match[1]
            return (f'    {{"name": "{match[1]}", "bytes": {file.stat().st_size},'
                    f' "checksum": {checksum(file.read_bytes())}}}')
        text = MEMBER.sub(renewed, path.read_text(encoding="utf-8"))
        text = text[:text.rindex(CHECKSUM)]
        path.write_text(f'{text}{CHECKSUM}{checksum(text.encode())}\n}}\n', encoding="utf-8")

    def assert_forgery_is_found(self, file, change, expected, name="case_0"):
        """Changes the content of a file and the manifest, and checks what is said of it."""
        contents = {**self.contents("results"), file: (self.results / file).read_bytes()}
        changed = change(contents[file])
        self.assertNotEqual(changed, contents[file], "nothing was changed")
        (self.results / file).write_bytes(changed)
        self.renew_manifest(name)
        self.assertRegex(self.verify(status=4), expected)
        for key, content in contents.items():
            (self.results / key).write_bytes(content)

    def assert_every_array_is_checked(self, *files):
        """Changes a number in the middle of each array of some grids."""
        for file in files:
            arrays, _, _ = read_vtu((self.results/file).read_bytes())
            for name, values in arrays.items():
                flat = [value for row in values for value in (row if isinstance(row, tuple) else (row,))]
                place = len(flat)//2
                # A real moves by a millionth of the largest one, an integer by one.
                if isinstance(flat[0], float):
                    value = struct.pack("<d", flat[place] + 1e-6*max(1e-3, *map(abs, flat)))
                else:
                    value = struct.pack("<i", flat[place] + 1)
                at = 8 + place*len(value)

                def change(content, name=name, at=at, value=value):
                    return change_array(content, name, lambda array: array[:at] + value + array[at + len(value):])
                with self.subTest(file=file, array=name):
                    self.assert_forgery_is_found(file, change, rf"results/{file}: {name} of .* follows from the other|"
                                                               "equilibrium")
