"""Resident memory of a process and its children while something runs."""

import asyncio
import time
from pathlib import Path

import numpy as np

PAGE_KIB = 4


def tree(pid: int) -> list[int]:
    """The process and all its descendants."""
    parents: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            except OSError:
                continue
            parents.setdefault(parent, []).append(int(entry.name))
    found = [pid]
    for one in found:
        found += parents.get(one, [])
    return found


def resident_kib(pids: list[int]) -> int:
    """Their resident memory together; shared pages count in each."""
    total = 0
    for pid in pids:
        try:
            total += int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE_KIB
        except OSError:
            continue
    return total


async def sample(pid: int, every_s: float, samples: list[tuple[float, int]]) -> None:
    """Append (time [s], memory [KiB]) until canceled."""
    began = time.monotonic()
    while True:
        samples.append((time.monotonic() - began, resident_kib(tree(pid))))
        await asyncio.sleep(every_s)


def slope_kib_per_min(samples: list[tuple[float, int]], skip_s: float) -> float:
    """Least squares over what comes after the first `skip_s`."""
    late = [(at, kib) for at, kib in samples if at >= skip_s]
    times, kib = np.array(late, dtype=float).T
    return float(np.polyfit(times / 60.0, kib, 1)[0])
