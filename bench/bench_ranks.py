#!/usr/bin/env python3
"""Measures the program over ranks of MPI on this machine and prints a Markdown table. Standard library only.

Usage: bench_ranks.py PROGRAM WORK N...

Row 1 of Table 1 on N x N cells, on one rank, which takes the program's own factorization, and on 2, 4 and 8, each with
one thread and taking turns where there are fewer cores. What is meaningful then: operations, processor time of all
ranks together, memory of each rank, bytes between them; wall times are not.
"""
import json
import os
import resource
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RANKS = (1, 2, 4, 8)
HEAD = ("| n | unknowns | ranks | Gflop | factor, 10^6 entries | memory of rank 0 MB | of the others MB "
        "| processor s | MB sent |\n|" + "---:|"*9)
os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1")


def measure(folder, *command):
    """One rank: runs the program and leaves its memory [MB] and processor time [s] in a file."""
    status = subprocess.run(command, check=False, stdout=subprocess.DEVNULL).returncode
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    rank = os.environ.get("OMPI_COMM_WORLD_RANK", "0")
    Path(folder, f"{rank}.used").write_text(f"{used.ru_maxrss/1024} {used.ru_utime + used.ru_stime}", "utf-8")
    return status


def bytes_sent(folder):
    """The bytes that all ranks sent [MB], from Open MPI's own monitoring: lines E or I, from, to, bytes."""
    rows = [line.split("\t") for path in folder.glob("sent.*.prof") for line in path.read_text("utf-8").splitlines()]
    return sum(int(row[3].split()[0]) for row in rows if row[0] in "EI" and row[1] != row[2])/1e6


def row(program, work, n, ranks):
    """One row of the table."""
    folder = work / f"ranks_{n}_{ranks}"
    folder.mkdir(parents=True, exist_ok=True)
    for path in [*folder.glob("*.used"), *folder.glob("sent.*")]:
        path.unlink()
    mpiexec = ["mpiexec", "--quiet", "--oversubscribe", "-n", str(ranks), "--mca", "pml_monitoring_enable", "1", "--mca",
               "pml_monitoring_enable_output", "3", "--mca", "pml_monitoring_filename", str(folder / "sent")]
    subprocess.run([*mpiexec, sys.executable, "-B", __file__, "--rank", str(folder), program, "--quiet", "--output",
                    str(folder), "--set", f"mesh.cells={n},{n}", str(ROOT / "input/long_bar_1.nml")],
                   check=True, stderr=subprocess.DEVNULL)
    factor = json.loads((folder / "long_bar_1.summary.json").read_text("utf-8"))["factor"]
    used = [tuple(map(float, (folder / f"{rank}.used").read_text("utf-8").split())) for rank in range(ranks)]
    others = max((memory for memory, _ in used[1:]), default=None)
    cells = [n, 2*n*(n + 1) + n + 1, ranks, f"{factor['flops']/1e9:.1f}", f"{factor['entries']/1e6:.1f}",
             f"{used[0][0]:.0f}", "" if others is None else f"{others:.0f}", f"{sum(time for _, time in used):.2f}",
             f"{bytes_sent(folder):.0f}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def main():
    """Returns the exit status."""
    if sys.argv[1] == "--rank":
        return measure(*sys.argv[2:])
    program, work = sys.argv[1], Path(sys.argv[2])
    print(HEAD)
    for n in map(int, sys.argv[3:]):
        for ranks in RANKS:
            print(row(program, work, n, ranks), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
