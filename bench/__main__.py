"""`python -m bench [--only NAME]... [--quick] [--output FOLDER]`: every subject, or some.

Each runs in a process of its own, held to the cores it may use, so that libraries with threads of
their own are measured on the same terms, and one that fails leaves the others alone.
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path

from bench.registry import ALL_CORES, SUBJECTS, Subject
from bench.results import FOLDER, read, rows_of

THREADS = (
    "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS",
    "RAYON_NUM_THREADS",
)  # fmt: skip


def main() -> int:
    """Runs the subjects and prints their lines; 1 when one of them failed to run."""
    parser = argparse.ArgumentParser(prog="bench", description=__doc__)
    parser.add_argument("--only", action="append", choices=SUBJECTS, metavar="NAME")
    parser.add_argument("--quick", action="store_true", help="small sets and few runs")
    parser.add_argument("--output", type=Path, help="default: bench/results, quick: build/bench")
    arguments = parser.parse_args()
    folder = arguments.output or (Path("build/bench") if arguments.quick else FOLDER)
    failures = 0
    for name in arguments.only or SUBJECTS:
        print(f"== {SUBJECTS[name].title}", flush=True)
        failures += run(SUBJECTS[name], folder, arguments.quick) != 0
        document = read(folder).get(name)
        for row in rows_of(document) if document else ():
            value = "failed" if row.value is None else f"{row.value:.4g} {row.unit}"
            verdict = {True: "reached", False: "NOT REACHED", None: ""}[row.reached]
            print(f"   {row.name}: {value}  {row.wanted} {verdict}  {row.note}", flush=True)
    return 1 if failures else 0


def run(subject: Subject, folder: Path, quick: bool) -> int:
    """A subject in a process of its own; the exit code."""
    cores = sorted(os.sched_getaffinity(0))
    allowed = cores if subject.cores == ALL_CORES else cores[-subject.cores :]
    threads = dict.fromkeys(THREADS, str(len(allowed)))
    command = [sys.executable, "-m", "bench.one", subject.name, str(folder)]
    process = subprocess.run(
        [*command, *(["--quick"] if quick else [])],
        env={**os.environ, **threads},
        preexec_fn=lambda: os.sched_setaffinity(0, allowed),
        check=False,
    )
    return process.returncode


if __name__ == "__main__":
    sys.exit(main())
