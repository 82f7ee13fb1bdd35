"""One subject in this process: `python -m bench.one NAME FOLDER [--quick]`; see `__main__`."""

import sys
import time
import traceback
from pathlib import Path

from bench.measure import failed
from bench.registry import SUBJECTS
from bench.results import as_document, write
from solver.comparison.machine import machine


def main(name: str, folder: Path, quick: bool) -> bool:
    """Measures and writes; an exception becomes a line of the results. Returns whether it went."""
    subject, about = SUBJECTS[name], machine()
    began, went = time.perf_counter(), True
    try:
        rows = subject.measure(quick)
    except Exception as error:
        traceback.print_exc()
        rows = [failed(subject.title, "", f"{type(error).__name__}: {error}", "to be measured")]
        went = False
    write(folder, as_document(subject, rows, about, quick, time.perf_counter() - began))
    return went


if __name__ == "__main__":
    sys.exit(not main(sys.argv[1], Path(sys.argv[2]), "--quick" in sys.argv[3:]))
