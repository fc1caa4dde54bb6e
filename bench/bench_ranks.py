#!/usr/bin/env python3
"""Measures the program over ranks of MPI on this machine and prints Markdown tables. Standard library only.

Usage: bench_ranks.py PROGRAM WORK N...

Row 1 of Table 1 on N x N cells, on one rank, which takes the program's own factorization, and on 2, 4, 8 and 16, each
with one thread and taking turns where there are fewer cores. What is meaningful then: operations, processor time,
memory of each rank, bytes between them; wall times are not. Below the table stand the models that fit it best, how far
they are from it at most, and what they say of larger bodies.
"""
import json
import math
import os
import resource
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RANKS = (1, 2, 4, 8, 16)
HEAD = ("| n | unknowns | ranks | Gflop | factor, 10^6 entries | memory of rank 0 MB | of the others MB "
        "| processor s | MB sent |\n|" + "---:|"*9)
PROJECTED = (1e7, 3e7, 1e8)
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


def launch(program, folder, n, ranks, *options):
    """Runs the bar on some ranks; returns memory [MB] and processor time [s] of each."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in [*folder.glob("*.used"), *folder.glob("sent.*")]:
        path.unlink()
    mpiexec = ["mpiexec", "--quiet", "--oversubscribe", "-n", str(ranks)]
    for name, value in (("enable", "1"), ("enable_output", "3"), ("filename", str(folder / "sent"))):
        mpiexec += ["--mca", f"pml_monitoring_{name}", value]
    subprocess.run([*mpiexec, sys.executable, "-B", __file__, "--rank", str(folder), program, "--quiet", "--set",
                    f"mesh.cells={n},{n}", *options, str(ROOT / "input/long_bar_1.nml")],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return [tuple(map(float, (folder / f"{rank}.used").read_text("utf-8").split())) for rank in range(ranks)]


def measured(program, work, n, ranks):
    """The numbers of one row of the table."""
    folder = work / f"ranks_{n}_{ranks}"
    used = launch(program, folder, n, ranks, "--output", str(folder))
    sent = bytes_sent(folder)
    summary = json.loads((folder / "long_bar_1.summary.json").read_text("utf-8"))
    # Mesh, order and analysis of rank 0, which waits for no one but to assemble, and what comes behind the solution.
    alone = None
    if ranks > 1:
        alone = launch(program, folder, n, ranks, "--check")[0][1] + sum(
            summary["seconds"][phase] for phase in ("recover", "write"))
    return {"n": n, "unknowns": 2*n*(n + 1) + n + 1, "ranks": ranks, "flops": summary["factor"]["flops"],
            "entries": summary["factor"]["entries"], "first": used[0][0],
            "others": max((memory for memory, _ in used[1:]), default=None), "seconds": sum(time for _, time in used),
            "alone": alone, "sent": sent}


def line(row):
    """A row of the table."""
    cells = [row["n"], row["unknowns"], row["ranks"], f"{row['flops']/1e9:.1f}", f"{row['entries']/1e6:.1f}",
             f"{row['first']:.0f}", "" if row["others"] is None else f"{row['others']:.0f}", f"{row['seconds']:.2f}",
             f"{row['sent']:.0f}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def fit(samples):
    """Least squares of relative errors: samples are terms and a value. Returns the factors and the largest error."""
    n = len(samples[0][0])
    scaled = [[term/value for term in terms] + [1.0] for terms, value in samples]
    matrix = [[sum(row[i]*row[j] for row in scaled) for j in range(n + 1)] for i in range(n)]
    for i in range(n):
        for k in range(n):
            if k != i:
                share = matrix[k][i]/matrix[i][i]
                matrix[k] = [a - share*b for a, b in zip(matrix[k], matrix[i])]
    factors = [matrix[i][n]/matrix[i][i] for i in range(n)]
    return factors, max(abs(sum(a*b for a, b in zip(factors, row)) - 1.0) for row in scaled)


def print_models(rows):
    """Prints what fits the rows of several ranks best, and what it says of larger bodies."""
    rows = [row for row in rows if row["ranks"] > 1]
    (flops,), flops_error = fit([([row["unknowns"]**1.5], row["flops"]) for row in rows])
    (base, growth), entries_error = fit([([row["unknowns"], row["unknowns"]*math.log2(row["unknowns"])],
                                          row["entries"]) for row in rows])
    memory, memory_error = fit([([1.0, 8e-6*row["entries"]/row["ranks"], 1e-6*row["unknowns"]*is_first], row[which])
                                for row in rows for is_first, which in enumerate(("others", "first"))])
    (sent,), sent_error = fit([([1e-6*row["unknowns"]*math.log2(row["ranks"])], row["sent"]) for row in rows])
    largest = max(row["n"] for row in rows)
    alone = min(row["alone"]/row["unknowns"] for row in rows if row["n"] == largest)
    print(rf"""
Models of least squares for $N$ unknowns on $p$ ranks, with their largest deviation from the rows of several ranks:

* operations $F$ = {flops:.1f} $N^{{3/2}}$ ({100*flops_error:.0f} %)
* entries of the factor $E = N$ ({base:.1f} + {growth:.2f} $\log_2 N$) ({100*entries_error:.0f} %)
* memory {memory[0]:.0f} MB + {memory[1]:.2f} $\cdot 8 E/p$ bytes, of rank 0 {memory[2]:.0f} $N$ bytes more """
          rf"""({100*memory_error:.0f} %)
* bytes sent $B$ = {sent:.0f} $N \log_2 p$ ({100*sent_error:.0f} %)
* processor time of rank 0 alone $T_0$ = {1e6*alone:.1f} $N$ microseconds (the least at $n$ = {largest})

| unknowns | operations | factor GB | rank 0 alone GB | ranks of 64 GB | wall time on a cluster |
|---:|---:|---:|---:|---:|---:|""")
    for unknowns in PROJECTED:
        entries = unknowns*(base + growth*math.log2(unknowns))
        alone_gb = 1e-9*memory[2]*unknowns
        ranks = math.ceil(memory[1]*8e-9*entries/(64.0 - alone_gb - 1e-3*memory[0]))
        print(f"| {unknowns:.0e} | {flops*unknowns**1.5:.1e} | {8e-9*entries:.0f} | {alone_gb:.1f} | {ranks} | |"
              .replace("e+0", "e").replace("e+", "e"))


def main():
    """Returns the exit status."""
    if sys.argv[1] == "--rank":
        return measure(*sys.argv[2:])
    program, work = sys.argv[1], Path(sys.argv[2])
    print(HEAD)
    rows = []
    for n in map(int, sys.argv[3:]):
        for ranks in RANKS:
            rows.append(measured(program, work, n, ranks))
            print(line(rows[-1]), flush=True)
    print_models(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
