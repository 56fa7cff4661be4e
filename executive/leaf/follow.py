"""Follow a trajectory to its end: the step that several leaves share."""

from collections.abc import Generator

import numpy as np

from executive.interfaces.robot import Robot
from executive.leaf.context import Context
from executive.leaf.loaded_stop import least_stop_s, stop_now_s
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.command import START_TOLERANCE, Follow, LimitStop
from executive.messages.trajectory import JointTrajectory

_SETTLED = 0.002  # [rad] or [m]: at 8 m from the turning axis 2 mrad are 16 mm
_GOAL_TOLERANCE = 0.02  # [rad] or [m]: largest lasting error of a servo under load
_STALL_S = 2.0  # at rest away from the goal for so long: something blocks the arm
_STALL_SPEED = 0.005  # [rad/s] or [m/s]
_STANDS = 0.95  # probability from which the ground is taken to carry the load, as by `IsHanging`
_START_SHARE = 0.9  # of the robot's own tolerance, which it compares with a later sample


def follow(
    context: Context, trajectory: JointTrajectory, load_kg: float = 0.0
) -> Generator[None, None, Outcome[None]]:
    """Command a trajectory and wait for its end; when cancelled, stop along the path.

    Fails without moving if the arm is not where the trajectory begins: a load that slips can push
    it after planning. With a load on supports that yield, a stop is no quicker than they bear, and
    one that begins as the ground carries the load no slower than the arm alone asks for.

    Args:
        context: The leaf's view of the mission.
        trajectory: The motion.
        load_kg: What may come to hang in the jaws on the way, where that is more than now [kg].
    """
    robot = context.use(Robot)
    away = np.abs(position_of(context, trajectory) - trajectory.position[0])
    if away.max() > _START_SHARE * START_TOLERANCE:
        name = trajectory.names[int(away.argmax())]
        return failed(f"{name} has moved {away.max():.3f} since the path was planned: plan again")
    stop_s = least_stop_s(context, trajectory, load_kg)
    robot.command(Follow(trajectory, stop_s))
    is_over = False
    try:
        outcome = yield from _arrive(context, trajectory)
        is_over = outcome.success
    finally:
        if not is_over:
            if stop_s > 0.0 and (context.standing() or 0.0) >= _STANDS:
                robot.command(LimitStop(min(stop_now_s(context, 0.0), stop_s)))
            robot.stop()
    return outcome


def _arrive(context: Context, trajectory: JointTrajectory) -> Generator[None, None, Outcome[None]]:
    started_s = still_since_s = context.now_s()
    goal = trajectory.position[-1]
    before = position_of(context, trajectory)
    before_s = started_s
    while True:
        yield None
        now_s, position = context.now_s(), position_of(context, trajectory)
        error = np.abs(position - goal)
        is_over = now_s - started_s >= trajectory.duration_s
        if is_over and (error < _SETTLED).all():
            return succeeded()
        if (
            now_s - before_s >= 0.5
        ):  # speed by differences over half a second: encoder noise does not look like motion
            if (np.abs(position - before) > _STALL_SPEED * (now_s - before_s)).any():
                still_since_s = now_s
            elif is_over and (error < _GOAL_TOLERANCE).all():
                return succeeded(
                    reason=f"{trajectory.names[int(error.argmax())]} is {error.max():.3f} off"
                )
            before, before_s = position, now_s
        if is_over and now_s - still_since_s >= _STALL_S:
            worst = int(error.argmax())
            return failed(f"{trajectory.names[worst]} is {error[worst]:.3f} off its goal")


def position_of(context: Context, trajectory: JointTrajectory) -> np.ndarray:
    """Return where the joints of a trajectory are now, shape (n,)."""
    sample = context.joints()
    return np.array([sample.of(name)[0] for name in trajectory.names])
