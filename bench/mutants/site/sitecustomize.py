"""Loads one file's module from other text, in every Python process of a test run.

MUTANT_SOURCE names the file and MUTANT_TEXT another one with its text; the file itself stays as it
is, and so does all that is kept of it on disk.
"""

import importlib.machinery
import os
import sys
from collections.abc import Sequence
from types import CodeType, ModuleType


class _Loader(importlib.machinery.SourceFileLoader):
    def get_code(self, fullname: str) -> CodeType:
        with open(os.environ["MUTANT_TEXT"], encoding="utf-8") as text:
            return compile(text.read(), self.path, "exec", dont_inherit=True)


class _Finder:
    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        spec = importlib.machinery.PathFinder.find_spec(fullname, path, target)
        if spec is None or spec.origin != os.environ["MUTANT_SOURCE"]:
            return None
        spec.loader = _Loader(fullname, spec.origin)
        return spec


if "MUTANT_SOURCE" in os.environ:
    sys.meta_path.insert(0, _Finder)
