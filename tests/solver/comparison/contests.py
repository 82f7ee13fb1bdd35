"""A contest small enough to know every figure of: where is (x - target)^2 + 1 least?"""

from typing import Any

from solver.comparison.contest import Account, Contest, Entrant, Published

TARGETS = (1.0, 2.0, 4.0)


def parabola(target: float, x: float) -> float:
    return (x - target) ** 2 + 1


def account(name: str, number: int, answer: Any) -> Account:
    """Holds if x is not beyond 5; its index is the parabola there, whatever the method says."""
    x, iterations = answer
    if x > 5:
        return Account(False, "joint_limit", "x is beyond 5", residuals={"excess_m": x - 5})
    return Account(
        True, "planned", index=parabola(TARGETS[number], x), residuals={"excess_m": 0.0},
        margin=5 - x, joints=(x,), iterations=iterations,
    )  # fmt: skip


def off_by(distance: float) -> Any:
    return lambda number: (TARGETS[number] + distance, 1)


def raises(number: int) -> Any:
    raise RuntimeError(f"no idea about {number}")


BEST = Entrant("ncos", "the least", off_by(0.0), off_by(0.1))
WORSE = Entrant("as", "half a metre off", off_by(0.5))
WRONG = Entrant("wrong", "beyond what is allowed", off_by(9.0))
RAISES = Entrant("raises", "has no idea", raises)
HALF = Entrant("half", "fails at the last target", lambda k: (TARGETS[k] + 2, 7))


def small_contest(*entrants: Entrant, ids: tuple[str, ...] = ("1", "2", "3")) -> Contest:
    return Contest(
        scenario="parabola",
        title="Three parabolas",
        origin="made up",
        index_name="height [m²]",
        target_ids=ids,
        entrants=entrants or (BEST, WORSE, WRONG, RAISES, HALF),
        account=account,
        notes=("Nothing to note.",),
        published={
            (ids[0], "ncos"): Published(1.0, 0.5),
            (ids[0], "as"): Published(1.5, 0.1),
            (ids[1], "as"): Published(index=2.0),
        },
        published_on="a desk",
        seeds=(7,),
    )
