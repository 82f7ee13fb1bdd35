"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

CHAIN_STENCIL_RAD: Final = 1e-4
"""Distance of the angles from which a posture's parabola is drawn [rad]: its slope is then good to
1e-8 and its curvature to 1e-7, from third differences and from rounding alike."""

CHAIN_REACH_RAD: Final = 0.03
"""How far an angle of a chain may move in the first round of polishing [rad]: what lies between two
nodes of the ladder graph, and more."""

CHAIN_STILL_RAD: Final = 1e-8
"""Reach of a round of polishing below which nothing is gained any more [rad]."""

CHAIN_ROUNDS: Final = 20
"""Most rounds of polishing."""

CHAIN_GAIN_RELATIVE: Final = 1e-11
"""Polishing ends where a round changes the effort by less, relative."""

CHAIN_MU_LEAST: Final = 1e-11
"""Width within which the l1 norm is rounded off at the end [rad]."""

CHAIN_MU_FACTOR: Final = 0.3
"""From one width to the next."""

CHAIN_NEWTON_STEPS: Final = 6
"""Newton steps for one width at most."""

ANNEAL_HOT: Final = 0.3
"""Temperature at the start of the search for an order, in efforts of a target on average."""

ANNEAL_COLD: Final = 0.005
"""Temperature at its end."""

ANNEAL_WINDOW: Final = 3
"""Places on each side of a change whose approaches are chosen anew."""

ANNEAL_LONGEST_RUN: Final = 3
"""Most targets that are moved elsewhere together."""

ANNEAL_LONGEST_TURN: Final = 50
"""Most targets that are turned about together."""

ANNEAL_STEP_RAD: Final = 0.262
"""Distance of the approach angles that an order is searched with [rad]; finer ones cost more and
end, for the same time, with dearer orders."""

ANNEAL_NEIGHBOURS: Final = 12
"""Targets cheap to reach a target from, behind one of which a run is moved that begins with it."""

ANNEAL_TRIALS: Final = 10_000
"""Moves tried for each target when an order is searched, about 1 us each."""

EXACT_TARGETS: Final = 8
"""Up to so many targets the order is exact."""

EXACT_STEP_RAD: Final = 0.0525
"""Distance of the approach angles when it is [rad]."""

EXACT_ORDERS_KEPT: Final = 24
"""Orders, cheapest on those angles, whose approaches are refined before one is taken."""

LADDER_STEP_RAD: Final = 0.0525
"""Distance of the angles at which the ladder graph of an order begins [rad], 120 on a turn."""

LADDER_KEPT: Final = 16
"""Nodes a target that are halved in the next round."""

LADDER_ROUNDS: Final = 3
"""Halvings; the angles are then 6.6 mrad apart, and polishing has no further to go than that."""
