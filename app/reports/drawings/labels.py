"""Text from outside in pictures."""

from typing import Final

LONGEST_LABEL: Final = 24


def plain_text(text: str) -> str:
    """Text as Matplotlib shows it without taking it for mathematics, cut where it is long."""
    shown = "".join(sign if sign.isprintable() else " " for sign in text)
    if len(shown) > LONGEST_LABEL:
        shown = shown[: LONGEST_LABEL - 1] + "…"
    return shown.replace("$", r"\$")
