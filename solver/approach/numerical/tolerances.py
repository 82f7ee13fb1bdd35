"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

NUMERICAL_STARTS: Final = 128
"""Start postures of the numerical inverse for each tool side. Of eight hard targets of two arms of
seven joints, with six seeds each, 64 leave 9 of 48 dearer than known by over 0.1 %, 128 leave 3."""

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

OTHER_FAMILY_RAD: Final = 0.1
"""Travel of some joint [rad or m] that makes a start of the direct search another: nearer ones
mostly end at the same place. 0.3 leaves 4 of those 48."""

DESCENT_STARTS: Final = 48
"""Starts of the direct search, the cheapest first. 24 leave 7 of those 48."""

DESCENT_DIRECTIONS: Final = 80
"""Directions that each may try, both ways. Where more would go on, the
programme does."""

DESCENT_ROWS: Final = 5
"""Rows in which it looks at a cut-in, a centimetre apart on four; what breaks between them is seen
in the end, when all are looked at."""

DESCENT_FIRST_STEP: Final = 0.2
"""First step of the direct search [rad or m]."""

DESCENT_LAST_STEP: Final = 1e-5
"""Step [rad or m] after which it ends: the programme goes on from there."""

DESCENT_GROWTH: Final = 1.6
"""Factor on the step after a direction that was cheaper."""

DESCENT_SHRINKAGE: Final = 0.85
"""Factor after one that was not: the step stays as it is where a quarter are cheaper."""

DESCENT_GAIN: Final = 1e-9
"""Effort that a step has to save [that of the norm]: less is rounding."""

DESCENT_REACHED: Final = 1e-11
"""Error [m and rad] of a trial that is back at the target: polishing it moves no joint by as much
as limits are exact to."""

DESCENT_RETURN_STEPS: Final = 8
"""Damped steps from a trial back to the target; what needs more has gone too far."""

SAME_OPTIMUM_RAD: Final = 1e-2
"""Joint travel [rad or m] between two ends of the direct search that are different optima."""
