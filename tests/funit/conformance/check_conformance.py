#!/usr/bin/env python3
"""Compares what test executables report with the verdicts pFUnit gave.

RULE is the regular expression that ctest looks for in the output: only a run with tests, all of them passed, fits it.
Usage: check_conformance.py EXPECTED.txt RULE NAME=EXECUTABLE ...
"""

import re
import subprocess
import sys
from pathlib import Path

NO_SUCH_TEST = "no_test_has_this_name"
FAILURE = re.compile(r"^Failure\n in: \n(\S+)\n  Location: \n(\[.*\])$", re.MULTILINE)
START = re.compile(r"^.*Start: <?([\w.]+)>?$", re.MULTILINE)
PASSED = re.compile(r"^ OK\n \((\d+) tests?(?:, (\d+) disabled)?\)$", re.MULTILINE)
FAILED = re.compile(r"^Tests run: (\d+), Failures: (\d+), Errors: (\d+)\n, Disabled: (\d+)$", re.MULTILINE)


def read_expected(path: Path) -> tuple:
    """The verdicts of the file, by executable, and the exit statuses, by run."""
    verdicts, statuses = {}, {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("== exit status: "):
            for run in line.removeprefix("== exit status: ").split(" (")[0].split(", "):
                name, status = run.rsplit(" ", 1)
                statuses[name] = int(status)
        elif line.startswith("== "):
            name, summary = line.removeprefix("== ").split(": ")
            current = verdicts[name] = {"totals": [int(number) for number in re.findall(r"\d+", summary)],
                                        "failures": [], "starts": []}
        elif line.startswith("F "):
            current["failures"].append(line.removeprefix("F "))
        elif line.startswith("S "):
            current["starts"].append(line.removeprefix("S "))
    return verdicts, statuses


def observe(rule: str, *command: str) -> dict:
    """What an executable reports."""
    run = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    summary = PASSED.search(run.stdout) or FAILED.search(run.stdout)
    return {"totals": [int(number or 0) for number in summary.groups()] if summary else [],
            "failures": [" ".join(failure) for failure in FAILURE.findall(run.stdout)],
            "starts": START.findall(run.stdout),
            "is passed": bool(re.search(rule, run.stdout)),
            "exit status": run.returncode}


def main() -> int:
    """Runs every executable and prints what differs."""
    executables = dict(word.split("=", 1) for word in sys.argv[3:])
    verdicts, statuses = read_expected(Path(sys.argv[1]))
    # Without a summary: the test that stops its process.
    verdicts["stop"] = {"totals": [], "failures": [], "starts": ["test_stop_suite.a_passes", "test_stop_suite.b_stops"]}
    verdicts["no test matched"] = {"totals": [0, 0], "failures": [], "starts": []}
    differences = 0
    for run, status in statuses.items():
        command = [executables["pass"], "--filter", NO_SUCH_TEST] if run == "no test matched" else [executables[run]]
        observed = observe(sys.argv[2], *command, "--verbose")
        expected = {**verdicts[run], "exit status": status, "is passed": run == "pass"}
        for topic in expected:
            if observed[topic] != expected[topic]:
                differences += 1
                print(f"{run}: {topic}: expected {expected[topic]}\n    found {observed[topic]}")
    print(f"{len(statuses)} runs compared, {differences} differences")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
