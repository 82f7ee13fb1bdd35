"""A drawn picture, and which there can be; apart from Matplotlib, which is slow to import."""

from dataclasses import dataclass
from typing import Final

POSES, EFFORT, TIMES = "poses.png", "effort.png", "times.png"
PICTURE_FILES: Final = (POSES, EFFORT, TIMES)


@dataclass(frozen=True)
class Picture:
    """A picture: its file's name, what it shows, and the PNG."""

    file: str
    caption: str
    png: bytes
