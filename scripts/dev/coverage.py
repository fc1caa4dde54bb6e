#!/usr/bin/env python3
"""Prints which lines and which error messages of src/ no test reached; fails where there are too many of either.

Usage: coverage.py BUILD

A message counts as raised if the procedure that its statement calls was called from there: gcov counts the calls of a
line, the last of which is that procedure's. `! not raised: REASON` above a statement tells why no test raises it; that
is a fault where a test does. Of `call require(..., RULE)`, which is always called, a test must expect the sentence.
"""
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

from check_sources import ROOT
from messages import messages, rules

LEAST_PERCENT = 92.0
LINE = re.compile(r"\s*([^:]+):\s*(\d+):")
CALL = re.compile(r"call +\d+ (returned (\d+)|never executed)")


def read_counters(build):
    """For each file of src/, the number of times its lines were run and the last call of each line was made."""
    runs = defaultdict(lambda: defaultdict(int))
    calls = defaultdict(lambda: defaultdict(int))
    notes = sorted((build/"src").rglob("*.gcno"))
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["gcov", "--branch-probabilities", "--branch-counts", "--preserve-paths", "--hash-filenames",
                        *map(str, notes)], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        for report in Path(folder).glob("*.gcov"):
            lines = report.read_text(encoding="utf-8", errors="replace").splitlines()
            path = Path(lines[0].partition("Source:")[2])
            if not path.is_relative_to(ROOT/"src"):
                continue
            number, last_call = 0, {}
            for line in lines:
                if match := LINE.match(line):
                    number = int(match[2])
                    if number > 0 and match[1] != "-":
                        runs[path][number] += int(match[1].rstrip("*")) if match[1][0].isdigit() else 0
                elif match := CALL.match(line):
                    last_call[number] = int(match[2] or 0)
            for number, count in last_call.items():
                calls[path][number] += count
    return runs, calls


def is_raised(message, runs, calls):
    """Whether a test came to the end of the statement that makes a message."""
    lines = range(message.last, message.first - 1, -1)
    for counters in (calls[message.path], runs[message.path]):
        for line in lines:
            if line in counters:
                return counters[line] > 0
    return False


def print_lines(runs):
    """Prints the share of lines of each room and which lines no test reached; returns the share of all, in percent."""
    totals = defaultdict(lambda: [0, 0])
    for path, counts in runs.items():
        for name in (path.relative_to(ROOT/"src").parent.as_posix(), "all"):
            totals[name][0] += len(counts)
            totals[name][1] += sum(count > 0 for count in counts.values())
    print("Lines that no test reached:")
    for path in sorted(runs):
        if missed := [str(line) for line, count in sorted(runs[path].items()) if count == 0]:
            print(f"   {path.relative_to(ROOT)}: {', '.join(missed)}")
    print(f"\n{'room':20}{'lines':>8}{'reached':>10}")
    for name, (n, n_reached) in sorted(totals.items(), key=lambda item: (item[0] == "all", item[0])):
        print(f"{name:20}{n:8}{100*n_reached/n:9.1f}%")
    return 100*totals["all"][1]/totals["all"][0]


def print_messages(runs, calls):
    """Prints the messages that no test raised; returns how many there are."""
    n_found = n_waived = n_faults = 0
    for message in messages():
        if message.path not in runs:
            continue
        raised = is_raised(message, runs, calls)
        n_found += 1
        n_waived += message.is_waived
        if raised == message.is_waived:
            n_faults += 1
            print(f"{message}: " + ("raised, and waived" if raised else f"not raised: {message.text}"))
    for rule in rules():
        n_found += 1
        n_faults += not rule.is_expected
        if not rule.is_expected:
            print(f"{rule}: no test expects '{rule.text}'")
    print(f"\n{n_found} messages, {n_faults} not raised, {n_waived} waived")
    return n_faults


def main(build):
    """Prints what was found; returns the exit status."""
    runs, calls = read_counters(Path(build).resolve())
    percent = print_lines(runs)
    n_faults = print_messages(runs, calls)
    if percent < LEAST_PERCENT:
        print(f"coverage.py: {percent:.1f} % of the lines are reached, at least {LEAST_PERCENT} % must be")
    return 0 if percent >= LEAST_PERCENT and n_faults == 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
