"""The one way kernels are compiled: Numba, cached on disk, IEEE arithmetic.

No fastmath, but for two liberties of `minimum` that change no result: no value is NaN, and the sign
of a zero does not matter.

Numba notices a changed file but not a changed function that it inlined from another file, so the
cache folder is named after everything a kernel depends on: Numba, Python, processor and the sources
of all kernels. A changed kernel therefore never meets an old binary.
"""

import hashlib
import logging
import os
import re
import sys
import tempfile
from pathlib import Path
from typing import cast

import llvmlite.binding as llvm
import numba
import numpy as np
from numba.core import config

_SOLVER = Path(__file__).parent
_MARK = "from solver.compiled import"
_IMPORT = re.compile(r"^\s*from (solver\.[\w.]+) import", re.MULTILINE)


def kernel_sources(solver: Path = _SOLVER) -> tuple[Path, ...]:
    """The files that compiled code depends on: kernels, and every file of ours that they import.

    What a kernel uses of another module, and what that one made of a third, is compiled into it.
    """
    texts = {file: file.read_text(encoding="utf-8") for file in solver.rglob("*.py")}
    waiting = [solver / "compiled.py", *(file for file in texts if _MARK in texts[file])]
    found: set[Path] = set()
    while waiting:
        file = waiting.pop()
        if file in found or file not in texts:
            continue
        found.add(file)
        modules = _IMPORT.findall(texts[file])
        waiting += [solver.parent / (module.replace(".", "/") + ".py") for module in modules]
    return tuple(sorted(found))


def cache_folder(solver: Path = _SOLVER) -> Path:
    """Where this machine keeps the compiled kernels of this version of the sources."""
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    digest = hashlib.sha256()
    for file in kernel_sources(solver):
        digest.update(file.read_bytes())
    cpu = llvm.get_host_cpu_name()  # type: ignore[no-untyped-call]
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    name = f"numba-{numba.__version__}-python-{python}-{cpu}-{digest.hexdigest()[:16]}"
    return root / "prunus" / "kernels" / name


def _choose_cache_folder() -> None:
    if os.environ.get("NUMBA_CACHE_DIR"):
        return
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        folder = Path(tempfile.mkdtemp(prefix="prunus-kernels-"))
        logging.getLogger(__name__).warning("kernels are compiled anew in %s: %s", folder, error)
    config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]


_choose_cache_folder()  # Numba reads it when a function is decorated, so it must be set before

kernel = numba.njit(cache=True, error_model="numpy", nogil=True)

minimum = numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"nnan", "nsz"})
"""For kernels that take the smallest of many values: as none is NaN, and the sign of a zero says
nothing, the compiler may take them in any order and several at once. Sums stay in their order."""

inlined = numba.njit(error_model="numpy", inline="always")
"""For the arithmetic of inner loops: without a call in it a loop over arrays is vectorised."""

NONE_YET = cast(int, np.int64(0))
"""What a count or a number begins with that is handed on. An integer in the code is a type of its
own to Numba, a literal, for which it compiles what is called once more."""

YES, NO = np.bool_(True), np.bool_(False)
"""The same of what is true or not."""
