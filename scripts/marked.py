"""Text between two markers of a Markdown file: what the code gives stands between them."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]


def with_marked(text: str, name: str, content: str) -> str:
    """The text with the content between `<!-- name -->` and `<!-- /name -->`."""
    marked = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
    replaced, places = marked.subn(lambda found: f"{found[1]}{content}{found[2]}", text)
    if places != 1:
        raise SystemExit(f"the markers of '{name}' must be there exactly once, not {places} times")
    return replaced
