#!/usr/bin/env python3
"""OpenBLAS's oldest kernels, which it takes on a processor it does not know, are replaced wherever the library is
loaded: by the program, by Python and whatever else calls C.

AMONTONS_LIBRARY names the shared library, UNKNOWN_PROCESSOR the one that makes the processor unknown.
"""
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

OLDEST = "Prescott"
# As a host of the library would: OpenBLAS is there and has chosen before the library is loaded.
HOST = """
import ctypes, os
blas = ctypes.CDLL("libopenblas.so.0")
blas.openblas_get_corename.restype = ctypes.c_char_p
print(blas.openblas_get_corename().decode())
ctypes.CDLL(os.environ["AMONTONS_LIBRARY"])
print(blas.openblas_get_corename().decode())
"""


def output(*command, **variables):
    """What a command prints."""
    return subprocess.run(command, env={**os.environ, **variables}, check=True, capture_output=True, text=True).stdout


def kernels_of_program(**variables):
    """The kernels that the program says it runs with."""
    return re.search("kernels (.*)", output(os.environ["AMONTONS"], "--version", **variables))[1]


def is_modern():
    """Whether the processor has the instructions that newer kernels need."""
    flags = re.search(r"^flags\s*:(.*)", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    return bool(flags) and {"avx2", "fma"} <= set(flags[1].split())


@unittest.skipUnless(is_modern(), "the processor has no instructions for newer kernels")
class UnknownProcessor(unittest.TestCase):
    """A processor that is newer than OpenBLAS."""

    def test_program_takes_kernels_by_instructions(self):
        kernels = kernels_of_program(LD_PRELOAD=os.environ["UNKNOWN_PROCESSOR"], OPENBLAS_CORETYPE=OLDEST)
        self.assertIn(kernels, ("Haswell", "SkylakeX"))

    def test_library_does_when_it_is_loaded(self):
        before, after = output(sys.executable, "-c", HOST, LD_PRELOAD=os.environ["UNKNOWN_PROCESSOR"],
                               OPENBLAS_CORETYPE=OLDEST).split()
        self.assertEqual(before, OLDEST)
        self.assertIn(after, ("Haswell", "SkylakeX"))

    def test_kernels_that_the_user_names_stay(self):
        self.assertEqual(kernels_of_program(OPENBLAS_CORETYPE=OLDEST), OLDEST)
        self.assertEqual(output(sys.executable, "-c", HOST, OPENBLAS_CORETYPE=OLDEST).split(), [OLDEST]*2)


if __name__ == "__main__":
    unittest.main()
