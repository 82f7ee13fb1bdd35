"""Options of the commands, checked with a message that names them."""

import math
from pathlib import Path

from hardware.exceptions import HardwareError


class BadOption(HardwareError):
    """An option's value that makes no sense; the message names the option."""

    code = "bad_option"


TIME_FACTORS = (1e-3, 1e6)


def check_time_factor(factor: float) -> None:
    """Refuse a time factor that makes no sense."""
    least, most = TIME_FACTORS
    if not least <= factor <= most:
        raise BadOption(f"--time-factor is between {least:g} and {most:g}")


def joints_from_degrees(text: str, count: int) -> tuple[float, ...]:
    """A joint vector [rad] from `count` numbers of degrees with commas between them."""
    try:
        degrees = [float(part) for part in text.split(",")]
    except ValueError:
        degrees = []
    if len(degrees) != count or not all(map(math.isfinite, degrees)):
        raise BadOption(f"--joints-deg is {count} numbers with commas between them")
    return tuple(map(math.radians, degrees))


def read_token(file: Path | None, given: str) -> str:
    """The service's token from a file, or the one given; empty if there is neither.

    Raises:
        BadOption: what should be a token is none; it is not repeated.
        OSError: the file cannot be read.
    """
    source = "PRUNUS_TOKEN" if file is None else "--token-file"
    token = (given if file is None else file.read_text(encoding="utf-8", errors="replace")).strip()
    if not (token.isascii() and token.isprintable() and " " not in token):
        raise BadOption(f"{source} has something else than a token")
    if file is not None and not token:
        raise BadOption(f"{source} is empty")
    return token
