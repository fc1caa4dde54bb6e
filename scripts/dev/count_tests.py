#!/usr/bin/env python3
"""Counts the tests of a ctest run from its JUnit file and prints `N passed, N failed`.

A unit test executable counts as the tests its summary tells; any other ctest test counts as one. An executable that
ctest failed although its summary tells of no failure (a crash after it, a time limit) counts as one failure more, and
so does a test that could not be started. An executable that is meant to fail counts as one test.
Usage: count_tests.py RESULTS.xml
"""
import re
import sys
import xml.etree.ElementTree as ElementTree

ALL_PASSED = re.compile(r"^ \((\d+) tests?(?:, (\d+) disabled)?\)$", re.MULTILINE)
SOME_FAILED = re.compile(r"^Tests run: (\d+), Failures: (\d+), Errors: (\d+)$", re.MULTILINE)


def count(case):
    """Returns how many tests of one ctest test passed, failed and were skipped."""
    status = case.get("status")
    reason = case.find("skipped")
    if status == "disabled" or reason is not None and reason.get("message", "").startswith("SKIP_"):
        return 0, 0, 1
    output = case.findtext("system-out", "")
    run = failed = skipped = 0
    for match in ALL_PASSED.finditer(output):
        run += int(match[1])
        skipped += int(match[2] or 0)
    for match in SOME_FAILED.finditer(output):
        run += int(match[1])
        failed += int(match[2]) + int(match[3])
    if status == "run":
        return (run, 0, skipped) if run > 0 and failed == 0 else (1, 0, 0)
    return run - failed, max(failed, 1), skipped


def main(path):
    """Prints the sums over all ctest tests; returns the exit status."""
    counts = [count(case) for case in ElementTree.parse(path).iter("testcase")]
    passed, failed, skipped = (sum(column) for column in zip(*counts)) if counts else (0, 0, 0)
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 0 if passed > 0 and failed == 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
