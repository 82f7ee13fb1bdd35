import math
from itertools import pairwise

import pytest
from hypothesis import given

from solver.comparison.strawberry.analytic import solve_as
from solver.comparison.strawberry.command_sequence import (
    Command,
    PostureOutsideLimits,
    command_sequence,
)
from solver.comparison.strawberry.mechanism import JOINT_NAMES, Posture
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered, postures

RESET = dict(zip((*JOINT_NAMES, "psi"), (*MECHANISM.reset, 0.0), strict=True))


def played(commands: tuple[Command, ...], start: dict[str, float]) -> list[dict[str, float]]:
    """The posture after every command."""
    states = [dict(start)]
    for command in commands:
        if command.value is not None:
            states.append({**states[-1], command.joint: command.value})
    return states


@given(postures)
def test_commands_end_at_the_posture_and_back_at_the_reset(posture: Posture) -> None:
    sequence = command_sequence(MECHANISM, posture, 0.3)
    there = played(sequence.commands, RESET)[-1]
    assert [there[name] for name in JOINT_NAMES] == list(posture)
    assert there["psi"] == 0.3
    assert played(sequence.back, there)[-1] == RESET


@given(postures)
def test_the_arm_moves_above_the_canopy_only(posture: Posture) -> None:
    """Everything but the slide of z moves while the arm is the extra height above the target."""
    sequence = command_sequence(MECHANISM, posture)
    there = played(sequence.commands, RESET)[-1]
    for commands, start in ((sequence.commands, RESET), (sequence.back, there)):
        states = played(commands, start)
        for before, after in pairwise(states):
            if before["s32"] == after["s32"] and before != after:
                above = posture.s32_m - before["s32"]
                assert above == pytest.approx(sequence.extra_height_m, abs=1e-15)
    wanted = MECHANISM.extra_height_m
    assert sequence.shortened == (posture.s32_m - wanted < MECHANISM.s32.lower)
    if not sequence.shortened:
        assert sequence.extra_height_m == pytest.approx(wanted)
    assert all(
        span.lower <= command.value <= span.upper
        for command in (*sequence.commands, *sequence.back)
        for name, span in zip(JOINT_NAMES, MECHANISM.limits, strict=True)
        if command.joint == name and command.value is not None
    )


def test_order_is_that_of_remark_3() -> None:
    posture = answered(solve_as(MECHANISM, TARGETS[0])).posture
    sequence = command_sequence(MECHANISM, posture)
    assert [command.joint for command in sequence.commands] == [
        "end_effector", "s32", "s10", "s21", "theta", "beta", "psi", "s32", "end_effector",
    ]  # fmt: skip
    assert [sequence.commands[0].action, sequence.commands[-1].action] == ["open", "close"]
    assert not sequence.shortened


@pytest.mark.parametrize("joint", range(5))
def test_a_posture_outside_the_limits_is_not_commanded(joint: int) -> None:
    values = list(MECHANISM.reset)
    values[joint] = MECHANISM.limits[joint].upper + 1e-3
    with pytest.raises(PostureOutsideLimits) as caught:
        command_sequence(MECHANISM, Posture(*values))
    assert caught.value.joint == JOINT_NAMES[joint]


@pytest.mark.parametrize("psi", [math.radians(91), -math.radians(91), math.nan])
def test_nor_is_a_turn_of_the_end_effector(psi: float) -> None:
    with pytest.raises(PostureOutsideLimits, match="psi"):
        command_sequence(MECHANISM, MECHANISM.reset, psi)
