"""Runs a command of the package: python -m amontons plot|report|adapt|fclib ..."""
import sys

from amontons.commands import main

if __name__ == "__main__":
    main(sys.argv[1:])
