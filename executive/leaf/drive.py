"""Drive the chassis along a path, with checks of its own: the step behind `MoveBase`."""

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from executive.config import Meters, Seconds, Settings
from executive.errors import RobotError
from executive.events.driving import DriveEnded, DriveFailed, DriveStarted
from executive.geometry.rotation import wrap_angle, yaw_of
from executive.interfaces.driving import DrivePlanner
from executive.interfaces.robot import Robot
from executive.leaf.context import Context
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.command import Drive
from executive.messages.drive import BasePath, DriveTrouble, Steering
from executive.watch.estimate_watch import estimate_trouble
from executive.watch.rules import EstimateRule

_STANDS_M_S = 0.03  # estimated speed of a chassis at rest: three times its noise
_STANDS_S = 0.5  # for so long: by then it has braked from that speed
_SLOPE_MARGIN_RAD = 0.05  # over the machine's limit: wheels pass over ruts that no plane shows


class DriveSettings(Settings):
    off_path: Meters = Field(
        0.5, gt=0, le=5, description="Distance from the path from which it is left [m]."
    )
    patience: Seconds = Field(
        3.0,
        gt=0,
        le=60,
        description="How long the machine may stand still on its path, or the estimate be out of "
        "use, before the drive has failed [s].",
    )


@dataclass(frozen=True, slots=True)
class Stopped:
    """Why a drive was stopped.

    Attributes:
        trouble: The kind.
        reason: The same for a person.
    """

    trouble: DriveTrouble
    reason: str


def drive(
    context: Context, path: BasePath, settings: DriveSettings
) -> Generator[None, None, Outcome[None]]:
    """Follow a path of the chassis to its end, where the machine stands; brake when cancelled.

    Args:
        context: The leaf's view of the mission; it needs the robot and driving.
        path: The path; it begins where the machine stands.
        settings: When to give up.
    """
    robot, began_s, is_over = context.use(Robot), context.now_s(), False
    context.record(DriveStarted(path.goal_map, path.length_m))
    try:
        stopped = yield from _DriveWatch(context, path, settings).follow(robot)
        is_over = stopped is None
    finally:
        if not is_over:
            robot.stop()
    standing = yield from _come_to_rest(context)
    stopped = stopped or standing
    if stopped is not None:
        return refused(context, stopped.trouble, stopped.reason)
    off_m, off_rad = _off_goal(context, path)
    lasted_s = round(context.now_s() - began_s, 6)
    context.record(DriveEnded(path.goal_map, off_m, off_rad, lasted_s))
    return succeeded(reason=f"{path.length_m:.1f} m, {off_m:.2f} m off the goal")


def refused(context: Context, trouble: DriveTrouble, reason: str) -> Outcome[None]:
    """Record why the machine does not drive, and return the failure."""
    context.record(DriveFailed(trouble, reason, context.state().T_map_base))
    return failed(f"{trouble}: {reason}")


class _DriveWatch:
    """One drive: what is commanded at each tick, and what ends it."""

    def __init__(self, context: Context, path: BasePath, settings: DriveSettings) -> None:
        self._context, self._path, self._settings = context, path, settings
        self._planner = context.use(DrivePlanner)
        self._along_m = self._best_m = 0.0
        self._well_s = self._moved_s = context.now_s()
        # Legs that are down, as at first and after a pause, are raised before it moves.
        self._patience_s = settings.patience + _legs_s(context)

    def follow(self, robot: Robot) -> Generator[None, None, Stopped | None]:
        """Drive to the end, and brake there; return what stopped it before, or None."""
        while True:
            steering = self._planner.steer(
                self._path, self._along_m, self._context.state().T_map_base
            )
            self._along_m = steering.along_m
            if steering.left_m <= 0.0:
                robot.command(Drive(0.0, 0.0))
                return None
            if (stopped := self._stopped(steering)) is not None:
                return stopped
            try:
                robot.command(self._command(steering))
            except RobotError as error:
                return Stopped(DriveTrouble.REFUSED, str(error))
            yield None

    def _command(self, steering: Steering) -> Drive:
        """Return what to command: to stand still as long as the estimate is out of use."""
        is_known = self._well_s >= self._context.now_s()
        return Drive(steering.speed_m_s if is_known else 0.0, steering.curvature_1_m)

    def _stopped(self, steering: Steering) -> Stopped | None:
        """Return why the drive has to end now, or None."""
        s, now_s = self._settings, self._context.now_s()
        if unknown := self._unknown():
            if now_s - self._well_s > s.patience:
                return Stopped(DriveTrouble.ESTIMATE, f"{unknown} for {now_s - self._well_s:.1f} s")
            self._moved_s = now_s
            return None
        self._well_s = now_s
        if steering.off_m > s.off_path:
            told = f"the machine is {steering.off_m:.2f} m off its path"
            return Stopped(DriveTrouble.OFF_PATH, told)
        if steep := self._steep():
            return Stopped(DriveTrouble.TOO_STEEP, steep)
        if steering.along_m > self._best_m + _STANDS_M_S:
            self._best_m, self._moved_s = steering.along_m, now_s
        if now_s - self._moved_s > self._patience_s:
            told = f"the machine has not moved on for {now_s - self._moved_s:.1f} s"
            return Stopped(DriveTrouble.NOT_MOVING, told)
        return None

    def _unknown(self) -> str:
        """Return why the estimate may not be used; its age is watched by the mission."""
        state = self._context.state()
        return estimate_trouble(state, state.stamp_s, np.inf, _USABLE)

    def _steep(self) -> str:
        limits = self._context.machine().driving
        if limits is None:
            return ""
        up = float(self._context.state().T_map_base[2, 2])
        tilt = float(np.arccos(np.clip(up, -1.0, 1.0)))
        if tilt <= limits.max_slope_rad + _SLOPE_MARGIN_RAD:
            return ""
        most = np.degrees(limits.max_slope_rad)
        return f"the chassis leans by {np.degrees(tilt):.0f}°, and it drives on up to {most:.0f}°"


def _legs_s(context: Context) -> float:
    limits = context.machine().driving
    return limits.legs_s if limits is not None else 0.0


def _come_to_rest(context: Context) -> Generator[None, None, Stopped | None]:
    """Wait until the chassis stands by the estimate; return what is wrong if it does not.

    A machine with legs has had the time to stand on them by then.
    """
    limits, began_s = context.machine().driving, context.now_s()
    limit_s = 2 * _STANDS_S + 2 * (limits.stop_s(limits.max_speed_m_s) if limits else 0.0)
    limit_s += _legs_s(context)
    moved_s = began_s + _legs_s(context)
    while context.now_s() - moved_s < _STANDS_S:
        yield None
        speed_m_s = float(np.linalg.norm(context.state().v_map_cabin))
        if speed_m_s >= _STANDS_M_S:
            moved_s = max(moved_s, context.now_s())
        if context.now_s() - began_s > limit_s:
            told = f"it still moves with {speed_m_s:.2f} m/s after it was told to stand"
            return Stopped(DriveTrouble.OFF_PATH, told)
    return None


_USABLE = EstimateRule(do="tell")  # the statuses and deviations of the default rule


def _off_goal(context: Context, path: BasePath) -> tuple[float, float]:
    """Return how far the chassis is from the end of a path [m], and turned from it [rad]."""
    T, (x, y, yaw) = context.state().T_map_base, path.goal_map
    away_m = float(np.hypot(T[0, 3] - x, T[1, 3] - y))
    return away_m, abs(wrap_angle(yaw_of(T[:3, :3]) - yaw))
