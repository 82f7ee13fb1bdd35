"""Every threshold on the side of the servos, with its unit and its reason.

Times are robot time: with a simulated bus that runs faster, so do they.
"""

from typing import Final

# --- The bus --------------------------------------------------------------------------------------
REPLY_TIMEOUT_S: Final = 0.05
"""Wait for a status packet, on the wall clock [s]: an adapter may hold bytes back for 16 ms twice,
and a busy machine needs room."""

ATTEMPTS: Final = 3
"""How often a packet is sent before its servo counts as missing or its answers as corrupt. Single
corrupt packets are routine on these buses; eight silent servos are known in 1.2 s, which is less
than the link's SILENCE_S."""

SERIAL_POLL_S: Final = 0.002
"""How long one read of the port waits for bytes [s]; the SDK asks again until its own time-out."""

WRITE_TIMEOUT_S: Final = 0.5
"""A port that takes no bytes for so long is lost [s]; a packet needs half a millisecond."""

# --- Streaming ------------------------------------------------------------------------------------
TICK_S: Final = 0.02
"""Period of the control loop [s], that of the planned trajectories' rows."""

IDLE_TICK_S: Final = 0.05
"""Period while nothing moves [s]: a round of all joints takes a third of a second."""

LOWEST_SPEED_RAD_S: Final = 0.1
"""Least speed that is commanded [rad/s]: a joint that is due to move less than a count in a tick
gets there all the same, and rounding never reaches 0, which is full speed."""

CATCH_UP: Final = 1.1
"""Commanded speed over the speed that the step needs: a servo that fell behind makes it up."""

SPEED_EXCESS: Final = 1.05
"""Steps faster than this share of a joint's velocity limit are refused: verified plans are inside
the limit, and rounding of a row's time must not stop one."""

LIMIT_TICKS: Final = 2
"""A goal may be beyond a joint limit by this many counts: joints 4 and 6 reach the ends of their
servos' range at their limits, so rounding decides the last count."""

JOINED_RAD: Final = 1e-6
"""Two segments join where their rows differ by less [rad]: a thousandth of a servo's count."""

PAUSE_RAMP_S: Final = 0.5
"""Time from full pace to a stand on the path [s]: at 2 rad/s that is 4 rad/s2, a third to two
thirds of the planned accelerations, which come on top."""

APPROACH_SHARE: Final = 0.25
"""Share of the velocity and acceleration limits on the way from where the arm is to a plan's start:
that way is verified against nothing but the joint limits, so somebody has to see it come."""

# --- Arrival and measurement ----------------------------------------------------------------------
SETTLE_TICKS: Final = 3
"""Counts from its goal within which a servo has arrived: one of its compliance margin, one of read
noise, one of rounding."""

SETTLE_S: Final = 2.0
"""A servo that has not arrived after so long is stuck [s]."""

MEASURED_READS: Final = 5
"""Reads whose mean is a measured posture: one read's noise moves the tool by up to 3.7 mm."""

LARGEST_CALIBRATION_RAD: Final = 0.17
"""A joint that reads further off than this [rad], 10 degrees, is not miscalibrated: the posture was
given wrongly, or a horn is mounted a tooth away. The thesis's largest offset is one degree."""

# --- Watching -------------------------------------------------------------------------------------
FOLLOWING_RAD: Final = 0.2
"""Distance of a joint from its goal that counts as lagging [rad]: five ticks' travel at 2 rad/s."""

PAIR_RAD: Final = 0.05
"""Distance of the two servos of a pair that counts as disagreement [rad]: 3 degrees. Two RX-64 with
a count of noise each are up to 0.01 apart, and 2 ms between their reads are 0.004 at 2 rad/s."""

PERSISTENT_POLLS: Final = 3
"""How many reads in succession must lag or disagree before it is a fault: a third of a second. One
may be a machine that was busy between a command and a read."""

STILL_TICKS: Final = 3
"""Two reads of a servo that stands differ by at most this: a count of noise each, and one of
settling."""

STILL_S: Final = 1.5
"""After a hold was commanded, time in which the servos have to come to a stand [s]."""

STILL_INTERVAL_S: Final = 0.1
"""Time between two reads that show whether a servo stands [s]: at 0.1 rad/s 2 counts of an RX."""

HOLD_SPEED_RAD_S: Final = 0.3
"""Speed towards the posture that is held [rad/s]; it is where the arm stands."""

TORQUE_JUMP_TICKS: Final = 4
"""Counts by which a servo may move when its torque comes on: settling and noise."""

# --- End-effector ---------------------------------------------------------------------------------
GUARD_S: Final = 0.5
"""The end-effector's guard switches off when it was not told so long to stay on [s, wall clock]."""

RENEW_S: Final = 0.1
"""How often it is told [s, wall clock]: five times in that."""

GUARD_ANSWER_S: Final = 0.5
"""A guard that does not answer for so long is lost [s, wall clock]. Not longer than GUARD_S: so no
dwell lasts longer than it was asked to by more than this."""

GUARD_START_S: Final = 5.0
"""A guard that has not said so long after its start that the output is off does not work [s, wall
clock]; an interpreter has to start first."""

# --- Link -----------------------------------------------------------------------------------------
TELEMETRY_S: Final = 0.1
"""Between two telemetry messages [s, wall clock]."""

RECONNECT_S: Final = 0.5
"""Between two tries to join the service [s, wall clock]."""

LINK_POLL_S: Final = 0.01
"""How long the link waits for a message before it sends what is to be said [s, wall clock]."""
