"""Puts the demonstration's table (docs/pictures/table.md) into README.md, between its markers."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
MARKED = re.compile(r"(<!-- demo table -->\n).*?(<!-- /demo table -->)", re.DOTALL)


def main() -> None:
    readme = ROOT / "README.md"
    table = (ROOT / "docs/pictures/table.md").read_text(encoding="utf-8")
    text, places = MARKED.subn(lambda found: f"{found[1]}{table}{found[2]}", readme.read_text())
    if places != 1:
        raise SystemExit("README.md needs the demo table's markers exactly once")
    readme.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
