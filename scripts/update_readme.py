"""Puts the demonstration's table (docs/pictures/table.md) into README.md, between its markers."""

from scripts.marked import ROOT, with_marked


def main() -> None:
    readme = ROOT / "README.md"
    table = (ROOT / "docs/pictures/table.md").read_text(encoding="utf-8")
    readme.write_text(with_marked(readme.read_text("utf-8"), "demo table", table), "utf-8")


if __name__ == "__main__":
    main()
