#!/usr/bin/env python3
"""Counts the tests of a ctest run from its JUnit file and prints `N passed, N failed`.

A unit test executable counts as the tests its summary tells; any other ctest test counts as one. An executable that
ctest failed although its summary tells of no failure (a crash after it, a time limit) counts as one failure more, and
so does a test that could not be started. An executable that is meant to fail counts as one test.
Usage: count_tests.py RESULTS.xml
       count_tests.py --follow     reads what `ctest --verbose` prints and hands on a line for each test that ends, with
                                   the number of tests passed so far, and the output of those that fail; where none ends
                                   for ten seconds, the tests that run
"""
import re
import sys
import threading
import xml.etree.ElementTree as ElementTree

ALL_PASSED = re.compile(r"^ \((\d+) tests?(?:, (\d+) disabled)?\)$", re.MULTILINE)
SAID = re.compile(r"^(\d+): (.*)$")
ENDED = re.compile(r"^ *(\d+/\d+) Test +#(\d+): (\S+) \.*[ *]*(.*?) *$")
STARTED = re.compile(r"^ +Start +(\d+): (\S+)$")
# What --verbose adds besides.
BEGUN = re.compile(r"^(test \d+| +Start +\d+: .*|Test command: .*|Working Directory: .*|Environment variables: *|"
                   r" \w+=.*|Test timeout computed to be: .*|The following tests passed:|\t\w+|)$")
SOME_FAILED = re.compile(r"^Tests run: (\d+), Failures: (\d+), Errors: (\d+)$", re.MULTILINE)


def count(case):
    """Returns how many tests of one ctest test passed, failed and were skipped."""
    status = case.get("status")
    reason = case.find("skipped")
    if status == "disabled" or reason is not None and reason.get("message", "").startswith("SKIP_"):
        return 0, 0, 1
    return count_output(case.findtext("system-out", ""), status == "run")


def count_output(output, has_passed):
    """Returns how many tests passed, failed and were skipped by the output of one ctest test."""
    run = failed = skipped = 0
    for match in ALL_PASSED.finditer(output):
        run += int(match[1])
        skipped += int(match[2] or 0)
    for match in SOME_FAILED.finditer(output):
        run += int(match[1])
        failed += int(match[2]) + int(match[3])
    if has_passed:
        return (run, 0, skipped) if run > 0 and failed == 0 else (1, 0, 0)
    return run - failed, max(failed, 1), skipped


def follow(lines):
    """Prints a line for each ctest test that ends, and what runs where none does for ten seconds."""
    output, running, passed = {}, {}, 0
    has_printed, is_over = threading.Event(), threading.Event()

    def wait():
        while not is_over.is_set():
            if not has_printed.wait(10.0):
                print(f"{passed} passed so far; running: {', '.join(list(running.values())) or 'none'}", flush=True)
            has_printed.clear()

    waiting = threading.Thread(target=wait, daemon=True)
    waiting.start()
    for line in lines:
        said, begun, ended = SAID.match(line), STARTED.match(line), ENDED.match(line)
        if said:
            output.setdefault(said[1], []).append(said[2])
            continue
        if begun:
            running[begun[1]] = begun[2]
        elif ended:
            running.pop(ended[2], None)
            text = "\n".join(output.pop(ended[2], []))
            has_passed = ended[4].startswith("Passed")
            passed += count_output(text, has_passed)[0]
            if not has_passed and not ended[4].startswith(("Skipped", "Not Run (Disabled)")):
                print(text)
            print(f"{ended[1]} {ended[3]}: {ended[4]}; {passed} passed so far", flush=True)
            has_printed.set()
        elif not BEGUN.match(line):
            print(line, end="", flush=True)
            has_printed.set()
    is_over.set()
    has_printed.set()
    waiting.join()


def main(path):
    """Prints the sums over all ctest tests; returns the exit status."""
    counts = [count(case) for case in ElementTree.parse(path).iter("testcase")]
    passed, failed, skipped = (sum(column) for column in zip(*counts)) if counts else (0, 0, 0)
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 0 if passed > 0 and failed == 0 else 1


if __name__ == "__main__":
    sys.exit(follow(sys.stdin) if sys.argv[1] == "--follow" else main(sys.argv[1]))
