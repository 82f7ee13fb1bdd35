"""What the verifier finds: recomputed errors, each beside what is allowed."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Residual:
    """One recomputed error and what is allowed; a value that is not a number is not accepted."""

    name: str
    value: float
    allowed: float

    @property
    def accepted(self) -> bool:
        """Whether the value is within what is allowed."""
        return bool(self.value <= self.allowed)


@dataclass(frozen=True)
class Verification:
    """All residuals of one approach."""

    residuals: tuple[Residual, ...]

    @property
    def accepted(self) -> bool:
        """Whether every residual is."""
        return all(residual.accepted for residual in self.residuals)

    @property
    def failures(self) -> tuple[Residual, ...]:
        """The residuals that are not."""
        return tuple(residual for residual in self.residuals if not residual.accepted)
