"""The commands of the package: amontons-plot, amontons-report and amontons-adapt, also `python -m amontons plot`,
`... report` and `... adapt`, `python -m amontons fclib`, and amontons, the program, where it is part of the package.
"""
from __future__ import annotations

import argparse
import importlib
import logging
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

WORDS = ("plot", "report", "adapt", "fclib")


class Parser(argparse.ArgumentParser):
    """Options of a command; what is wrong with them ends it with a sentence and status 1, as in the program."""

    def error(self, message: str) -> NoReturn:
        sys.exit(f"{self.prog}: {message}; try --help")


def run(word: str, arguments: Sequence[str]) -> NoReturn:
    """Runs a module of the package as a command."""
    # Where the home folder cannot be written to, Matplotlib takes a temporary one, and says so at length.
    logging.getLogger("matplotlib").addFilter(lambda record: not re.search("a temporary c|mkdir -p failed", record.msg))
    try:
        module = importlib.import_module(f"amontons.{word}")
    except ModuleNotFoundError as error:
        sys.exit(f"{word}: {sys.executable} has no package '{error.name}'; install it (Debian: python3-{error.name})")
    sys.exit(module.main(arguments))


def plot() -> NoReturn:
    """The command amontons-plot."""
    run("plot", sys.argv[1:])


def report() -> NoReturn:
    """The command amontons-report."""
    run("report", sys.argv[1:])


def adapt() -> NoReturn:
    """The command amontons-adapt."""
    run("adapt", sys.argv[1:])


def program() -> NoReturn:
    """The command amontons of a wheel: becomes the program in it."""
    path = str(Path(__file__).parent / "bin" / "amontons")
    os.execv(path, [path, *sys.argv[1:]])


def main(arguments: Sequence[str]) -> NoReturn:
    """The command `python -m amontons`."""
    if not arguments or arguments[0] not in WORDS:
        sys.exit(f"usage: python -m amontons {'|'.join(WORDS)} ...")
    run(arguments[0], arguments[1:])
