"""Commands to a robot."""

from dataclasses import dataclass

from executive.messages.trajectory import JointTrajectory

# Largest distance of a trajectory's start from the arm's position [rad] or [m]; a robot refuses a
# trajectory that begins farther off.
START_TOLERANCE = 0.05

# How long a `Drive` counts [s]: without a newer one the machine brakes, so that a lost executive
# does not drive on. Six ticks of 50 ms.
DRIVE_HOLD_S = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class Follow:
    """Follow a trajectory from now on; it replaces the one that is being followed.

    Attributes:
        trajectory: The motion.
        stop_s: Least time in which a stop takes its whole speed away, and in which it is taken up
            again [s]; 0 where only the joints limit that. A safe stop is as fast as the joints may.
    """

    trajectory: JointTrajectory
    stop_s: float = 0.0


@dataclass(frozen=True, slots=True)
class MoveJaws:
    """Move the jaws towards a position, and hold the force there.

    Attributes:
        position_rad: Jaw angle; 0 is closed, larger is more open.
        force_n: Largest force at each tip [N].
    """

    position_rad: float
    force_n: float


@dataclass(frozen=True, slots=True)
class LimitStop:
    """Change the least time of a stop in the middle of the path under way; nothing without one.

    What hung in the jaws as the path began may stand on the ground by now: an arm that stopped as
    slowly as the load asked for would press on it meanwhile.

    Attributes:
        stop_s: As that of `Follow` [s].
    """

    stop_s: float


@dataclass(frozen=True, slots=True)
class SwitchLidars:
    """Start or stop the measurements of all lidars."""

    on: bool


@dataclass(frozen=True, slots=True)
class Drive:
    """Drive the chassis for `DRIVE_HOLD_S`, and then brake along the same arc.

    The robot approaches both figures within the machine's limits. It refuses the command while the
    arm moves or is not in the posture for driving, and it refuses `Follow` while the chassis moves.

    Attributes:
        speed_m_s: Speed of the base frame's origin along its x axis [m/s]; negative is backwards.
        curvature_1_m: Curvature of its path [1/m]; positive turns to the left when driving
            forwards, and the angular velocity is `speed_m_s * curvature_1_m`.
    """

    speed_m_s: float
    curvature_1_m: float


Command = Follow | LimitStop | MoveJaws | SwitchLidars | Drive
