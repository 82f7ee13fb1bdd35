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
"""Factor from one width to the next."""

CHAIN_NEWTON_STEPS: Final = 6
"""Newton steps for one width at most."""

CHAIN_HALVINGS: Final = 20
"""How often a Newton step is halved before it is given up: a millionth of it is left."""

CHAIN_DAMPING_RELATIVE: Final = 1e-12
"""What is added to the model's curvature in each angle, as a share of it: more than rounding takes
away in the elimination, so that pivots stay positive."""

CHAIN_DAMPING: Final = 1e-9
"""What is added to it besides [effort / rad2]: an angle that no joint's travel depends on has
none."""

CHAIN_ROUNDING_RELATIVE: Final = 1e-13
"""A Newton step that lowers the model's effort by less, relative, was the last for a width with l2:
the rest is rounding."""

CHAIN_WORTH_MU: Final = 0.1
"""The same with l1, as a share of the width: rounding the norm off within it changes more."""

ANNEAL_HOT: Final = 0.3
"""Temperature at the start of the search for an order, as a share of the mean effort of a target: a
move that costs that much is accepted every third time."""

ANNEAL_COLD: Final = 0.005
"""Temperature at the end of that search, as the same share: hardly a move that costs anything is
accepted."""

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

ANNEAL_COOLED_TRIALS: Final = 64
"""Moves between two temperatures, so that not every move pays for a power."""

ANNEAL_TURN_SHARE: Final = 0.25
"""Share of the moves that turn a run about where it is."""

ANNEAL_TRIALS: Final = 10_000
"""Moves tried for each target when an order is searched, about 1 us each."""

EXACT_TARGETS: Final = 8
"""Up to so many targets every order is counted: memory and time double with each further one."""

EXACT_STEP_RAD: Final = 0.0525
"""Distance of the approach angles that every order is counted with [rad]."""

EXACT_OPEN: Final = 64
"""Partial orders that may be open for each order kept and each target, which bounds the memory:
they are opened best first, with exact bounds."""

EXACT_ORDERS_KEPT: Final = 24
"""Orders, cheapest on those angles, whose approaches are refined before one is taken."""

LADDER_STEP_RAD: Final = 0.0525
"""Distance of the angles at which the ladder graph of an order begins [rad], 120 on a turn."""

LADDER_KEPT: Final = 16
"""Nodes a target that are halved in the next round."""

LADDER_ROUNDS: Final = 3
"""Halvings; the angles are then 6.6 mrad apart, and polishing has no further to go than that."""
