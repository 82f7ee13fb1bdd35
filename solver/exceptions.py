"""Misuse and broken parts, as exceptions with data. "No solution" is none: see solution.py."""

from dataclasses import dataclass


class SolverError(Exception):
    """Root of everything the solver raises on purpose."""


class UnknownRobot(SolverError):
    """No robot model has this name."""

    def __init__(self, name: str, *, known: tuple[str, ...]) -> None:
        super().__init__(f"unknown robot {name!r}; known: {', '.join(known)}")
        self.name = name
        self.known = known


class InvalidRobot(SolverError):
    """A robot model that cannot be read or makes no sense."""


class UnsupportedKinematics(SolverError):
    """The closed form does not cover this arm's geometry."""

    def __init__(self, robot: str, detail: str) -> None:
        super().__init__(f"{robot}: no closed-form inverse kinematics: {detail}")
        self.robot = robot
        self.detail = detail


@dataclass(frozen=True)
class Fault:
    """One thing wrong in a problem: `path` leads to the field as in the request's JSON.

    `detail` does not repeat the value, so that an answer never echoes what was sent.
    """

    path: tuple[str | int, ...]
    detail: str

    @property
    def pointer(self) -> str:
        """The path as a JSON pointer in URI fragment form (RFC 6901, section 6)."""
        steps = (str(step).replace("~", "~0").replace("/", "~1") for step in self.path)
        return "#" + "".join(f"/{step}" for step in steps)


class InvalidProblem(SolverError):
    """A problem that makes no sense, with every fault found."""

    def __init__(self, faults: tuple[Fault, ...]) -> None:
        super().__init__("; ".join(f"{fault.pointer}: {fault.detail}" for fault in faults))
        self.faults = faults


class UnknownScenario(SolverError):
    """No scenario has this name."""

    def __init__(self, name: str, *, known: tuple[str, ...]) -> None:
        super().__init__(f"unknown scenario {name!r}; known: {', '.join(known)}")
        self.name = name
        self.known = known


class UnknownEntrant(SolverError):
    """A scenario has no method of this name."""

    def __init__(self, name: str, *, known: tuple[str, ...]) -> None:
        super().__init__(f"unknown method {name!r} in this scenario; known: {', '.join(known)}")
        self.name = name
        self.known = known


class RetimingFailed(SolverError):
    """A chosen approach that does not hold any more: `detail` says what, of which target."""

    def __init__(self, target_id: str, detail: str) -> None:
        super().__init__(target_id, detail)  # as given, so that it passes between processes
        self.target_id = target_id
        self.detail = detail

    def __str__(self) -> str:
        return f"{self.target_id}: {self.detail}"
