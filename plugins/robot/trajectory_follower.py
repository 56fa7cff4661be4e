"""Follows a trajectory, and stops along its path by slowing down the time of the path."""

from typing import TypedDict

import numpy as np

from executive.arrays import Float, Int
from executive.errors import RobotError
from executive.machine.machine import Machine
from executive.messages.command import START_TOLERANCE
from executive.messages.trajectory import JointTrajectory

_POSITION_TOLERANCE = 1e-3  # tolerated excess over a range, below encoder resolution [rad] or [m]
_SPEED_TOLERANCE = 1.05  # cubic pieces slightly exceed the speeds at the samples
_PROBE_S = 1e-3  # step of the difference quotient for the acceleration of the path
_QUICKEST_STOP_S = 0.1  # shortest time in which ds/dt falls from 1 to 0
_LOOK_S = 0.01  # step in which a coming acceleration is computed


class KeptPath(TypedDict):
    """The reference and the path that is followed."""

    held: Float
    trajectory: JointTrajectory | None
    columns: Int
    progress: tuple[float, float]  # along the path [s], and its rate
    end: tuple[bool, bool]  # stopping, given up
    stop_s: float  # least time in which ds/dt falls from 1 to 0


class Follower:
    """Computes the reference of the arm at each step.

    The reference is a point s in the trajectory's own time. While following, ds/dt = 1. While
    stopping, ds/dt falls to 0 as fast as the acceleration limits of all joints allow, and no faster
    than the command asks for, so that the arm stays on the path that was checked for collisions:
    with q(s), the acceleration of the joints is q″ (ds/dt)² + q′ d²s/dt².

    In a pause the mission's time stands still while s goes on until the arm stands. After it the
    arm waits for so long that, when ds/dt is 1 again, s is as far as without a pause. Where
    accelerating takes more than braking has gained, `behind_s` says by how much.
    """

    def __init__(self, machine: Machine, position: Float) -> None:
        self._machine = machine
        self._index = {name: i for i, name in enumerate(machine.arm_names)}
        self._held = np.array(position)
        self._trajectory: JointTrajectory | None = None
        self._columns = np.zeros(0, dtype=np.int64)
        self._s, self._rate, self._is_stopping = 0.0, 1.0, False
        self._is_given_up = self._is_paused = False
        self._lead_s = self._wait_s = 0.0  # s beyond the mission's time; how long ds/dt stays
        self._stop_s = _QUICKEST_STOP_S

    @property
    def is_moving(self) -> bool:
        """Whether a trajectory is under way and not stopped."""
        return self._trajectory is not None and not (self._is_stopping and self._rate == 0.0)

    def follow(self, trajectory: JointTrajectory, position: Float, stop_s: float = 0.0) -> None:
        """Follow a trajectory from now on.

        Args:
            trajectory: Trajectory of some or all arm joints; the others keep their positions.
            position: Present positions of the arm, shape (n,).
            stop_s: Least time in which `stop` takes its whole speed away [s].

        Raises:
            RobotError: If it names an unknown joint, starts elsewhere, or exceeds the range or the
                speed of a joint.
        """
        unknown = [name for name in trajectory.names if name not in self._index]
        if unknown:
            raise RobotError(
                f"trajectory moves {', '.join(unknown)}; the arm has {', '.join(self._index)}"
            )
        columns = np.array([self._index[name] for name in trajectory.names], dtype=np.int64)
        self._check_start(trajectory, position[columns])
        self._check_limits(trajectory, columns)
        self._held = self._reference()[0]
        self._trajectory, self._columns = trajectory, columns
        self._s, self._rate, self._is_stopping = 0.0, 1.0, False
        self._is_given_up = False
        self._lead_s = self._wait_s = 0.0
        self.limit_stop(stop_s)

    def limit_stop(self, stop_s: float) -> None:
        """Change the least time in which `stop` takes the whole speed of the path away [s].

        It changes nothing once the path is given up: a stop for good stays as quick as it is.
        """
        if not self._is_given_up:
            self._stop_s = max(stop_s, _QUICKEST_STOP_S)

    def stop(self) -> None:
        """Slow down along the path and hold; the path is kept for `resume`.

        A second stop gives the path up: what was cancelled is not taken up by a later `resume`.
        """
        self._is_given_up = self._is_given_up or self._is_stopping
        self._is_stopping = True

    def give_up(self) -> None:
        """Slow down along the path, as fast as the joints may, and hold for good."""
        self._is_stopping = self._is_given_up = True
        self._stop_s = _QUICKEST_STOP_S

    def resume(self) -> None:
        """Accelerate again along a path that `stop` has interrupted, and that was not given up."""
        if not self._is_given_up:
            self._is_stopping = False

    def pause(self) -> None:
        """Note that the mission's time stands still from now on."""
        self._is_paused = True

    def go_on(self) -> None:
        """Note that the mission's time goes on, and be in step with it at the path's full speed."""
        self._is_paused = False
        self._wait_s = max(-self.behind_s(), 0.0) / (1.0 - self._rate) if self._rate < 1.0 else 0.0

    def behind_s(self) -> float:
        """Return by how much s is behind the mission's time at the end, if that goes on now [s].

        It is negative if the arm will be ahead, and 0 where there is nothing to go on along.
        """
        path = self._trajectory
        if path is None or self._is_given_up:
            return 0.0
        s, rate, lost_s = self._s, self._rate, 0.0
        while rate < 1.0 and s < path.duration_s:
            rate = min(rate + self._room(path, 1.0, s, rate) * _LOOK_S, 1.0)
            s += rate * _LOOK_S
            lost_s += (1.0 - rate) * _LOOK_S
        return lost_s - self._lead_s

    def position(self) -> Float:
        """Return the reference now, shape (n,)."""
        return self._reference()[0]

    def velocity(self) -> Float:
        """Return the velocity of the reference now, at a pace of 1, shape (n,)."""
        return self._reference()[1]

    def advance(self, dt_s: float, pace: float = 1.0) -> tuple[Float, Float]:
        """Advance by one step; return reference position and velocity, each shape (n,).

        Args:
            dt_s: The step [s].
            pace: Share of its speed that the path has for want of oil flow.
        """
        path = self._trajectory
        if path is None:
            return self._held, np.zeros_like(self._held)
        if self._is_stopping:
            self._rate = max(self._rate - self._room(path, -1.0, self._s, self._rate) * dt_s, 0.0)
        elif self._wait_s > 0.5 * dt_s:
            self._wait_s -= dt_s
        elif self._rate < 1.0:
            self._rate = min(self._rate + self._room(path, 1.0, self._s, self._rate) * dt_s, 1.0)
        self._s += pace * self._rate * dt_s
        self._lead_s += (self._rate - (not self._is_paused)) * dt_s
        position, velocity = self._reference()
        velocity = pace * velocity
        if self._s >= path.duration_s:
            self._held, self._trajectory = position, None
            velocity = np.zeros_like(velocity)
        return position, velocity

    def keep(self) -> KeptPath:
        """Return the reference and the path that is followed."""
        return {
            "held": self._held,
            "trajectory": self._trajectory,
            "columns": self._columns,
            "progress": (self._s, self._rate),
            "end": (self._is_stopping, self._is_given_up),
            "stop_s": self._stop_s,
        }

    def restore(self, kept: KeptPath) -> None:
        """Take back what `keep` returned."""
        self._held, self._trajectory = kept["held"], kept["trajectory"]
        self._columns = kept["columns"]
        self._s, self._rate = kept["progress"]
        self._is_stopping, self._is_given_up = kept["end"]
        self._stop_s = kept["stop_s"]

    def _reference(self) -> tuple[Float, Float]:
        position, velocity = self._held.copy(), np.zeros_like(self._held)
        if self._trajectory is not None:
            position[self._columns], slope = self._trajectory.at(self._s)
            velocity[self._columns] = slope * self._rate
        return position, velocity

    def _room(self, path: JointTrajectory, direction: float, s: float, rate: float) -> float:
        """Return the largest |d²s/dt²| that the command and the limits of all joints allow.

        The direction is 1 for speeding up and −1 for slowing down.
        """
        limit = self._machine.max_acceleration[self._columns]
        slope = path.at(s)[1]
        curve = (path.at(s + _PROBE_S)[1] - slope) / _PROBE_S * rate**2
        moves = np.abs(slope) > 1e-9
        room = (limit - direction * np.sign(slope) * curve)[moves] / np.abs(slope[moves])
        return float(np.clip(np.min(room, initial=1 / self._stop_s), 0.0, 1 / self._stop_s))

    def _check_start(self, trajectory: JointTrajectory, position: Float) -> None:
        for name, have, start in zip(
            trajectory.names, position, trajectory.position[0], strict=True
        ):
            if abs(start - have) > START_TOLERANCE:
                raise RobotError(
                    f"trajectory starts {name} at {start:.3f}, the joint is at "
                    f"{have:.3f}; plan from where the arm is"
                )

    def _check_limits(self, trajectory: JointTrajectory, columns: Int) -> None:
        machine = self._machine
        times = trajectory.times_s
        halves = [trajectory.at(time)[0] for time in (times[:-1] + times[1:]) / 2]
        positions = np.vstack([trajectory.position, *halves])
        # A load can press a joint a little beyond its range; its way back begins there.
        lower = np.minimum(machine.lower[columns], trajectory.position[0])
        upper = np.maximum(machine.upper[columns], trajectory.position[0])
        beyond = np.maximum(lower - positions, positions - upper).max(axis=0) > _POSITION_TOLERANCE
        speed = np.abs(trajectory.velocity).max(axis=0)
        for i, name in enumerate(trajectory.names):
            if beyond[i]:
                worst = positions[:, i].min(), positions[:, i].max()
                raise RobotError(
                    f"trajectory takes {name} to {worst[0]:.3f} … {worst[1]:.3f}, "
                    f"beyond {lower[i]} … {upper[i]}"
                )
            top = machine.max_velocity[columns[i]]
            if speed[i] > top * _SPEED_TOLERANCE:
                raise RobotError(
                    f"trajectory moves {name} at {speed[i]:.3f} per second; its limit is {top}"
                )
