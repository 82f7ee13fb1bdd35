"""The process that owns an end-effector's output: `python -m hardware.end_effector.guard OUTPUT`.

It takes a number and a word a line, `on`, `off` or `stay`, and answers with the number and the
state that it reads back; the first answer, number 0, comes at the start.
The output goes off when the line is closed, which a dead worker does, and when an output that is on
was not told to stay so for GUARD_S, which a hanging worker does not.
"""

import contextlib
import math
import signal
import sys
import time
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector

from hardware.end_effector.outputs import OUTPUTS, Output, word
from hardware.tolerances import GUARD_S


def guard(output: Output) -> None:
    """Obey the words on standard input until it is closed; the output is off before and after."""
    output.set(on=False, why="start")
    _answer("0", output)
    deadline = math.inf
    with DefaultSelector() as selector, open(0, "rb", buffering=0, closefd=False) as lines:
        selector.register(lines, EVENT_READ)
        while True:
            left = max(0.0, deadline - time.monotonic())
            has_word = selector.select(None if math.isinf(left) else left)
            if time.monotonic() >= deadline:
                # Even when a word waits: this process itself may have stood still.
                output.set(on=False, why="not told to stay on")
                deadline = math.inf
            if not has_word:
                continue
            number, _, word = lines.readline().decode().strip().partition(" ")
            if not number:
                return
            if word != "stay":
                output.set(on=word == "on", why="commanded")
            deadline = time.monotonic() + GUARD_S if output.is_on() else math.inf
            _answer(number, output)


def _answer(number: str, output: Output) -> None:
    print(number, word(output.is_on()), flush=True)  # noqa: T201 - the answer


def main(arguments: list[str]) -> None:
    """Run the guard. Ctrl-C is for the worker, which then closes the line."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    name, *record = arguments
    output = OUTPUTS[name](Path(record[0]) if record else None)
    try:
        guard(output)
    except OSError as error:
        sys.exit(f"the end-effector's guard: {error.strerror}")
    finally:
        with contextlib.suppress(OSError):
            output.set(on=False, why="end")


if __name__ == "__main__":
    main(sys.argv[1:])
