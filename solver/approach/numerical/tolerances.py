"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

NUMERICAL_STARTS: Final = 64
"""Start postures of the numerical inverse for each tool side. Of 200 reachable targets of a UR5, 8
starts solve 199, 32 all; from 32 to 64 the mean effort falls by 0.9 %, from there to 256 by 1.8 %,
in four times the time."""

NUMERICAL_REACH_STEPS: Final = 40
"""Damped steps towards the target from each start; from half the joint range 15 are usual."""

NUMERICAL_PULL_STEPS: Final = 60
"""Steps that lean towards the reference posture while the tool stays at the target."""

NUMERICAL_PULL_SHARE: Final = 0.3
"""Share of the way to the reference that such a step leans; smaller ones only take longer."""

NUMERICAL_MOST_STEP: Final = 0.5
"""Largest joint step [rad or m]: the Jacobian says nothing about what is further away."""

NUMERICAL_REACHED: Final = 1e-3
"""Error [m and rad] below which a start has come to the target and is polished."""

NUMERICAL_TURNS: Final = 4
"""Whole turns to either side on which a joint is tried nearer to the reference: more than the
limits of any arm here allow."""
