"""A robot without physics, for dry runs of trees.

Joints follow exactly, sensors are ideal, and lidars measure nothing.
"""

from collections.abc import Mapping, Sequence
from typing import TypedDict, cast

import numpy as np
from executive_plugins.robot.base_driver import BaseDriver, KeptBase
from executive_plugins.robot.latch import Latch
from executive_plugins.robot.sensor_noise import SensorNoise
from executive_plugins.robot.settings import KinematicSettings
from executive_plugins.robot.trajectory_follower import Follower, KeptPath

from executive.arrays import Float
from executive.errors import RobotError
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis, log_so3
from executive.interfaces.robot import Robot
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.command import Command, Drive, Follow, LimitStop, MoveJaws
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation

_STEP_S = 0.01  # 100 Hz: the rate of the IMUs and the encoders
_GNSS_EVERY = 5  # steps: 20 Hz
_UP = np.array([0.0, 0.0, 1.0])


class KeptMachine(TypedDict):
    """The state of the simulated machine."""

    steps: int
    arm: tuple[Float, Float]
    jaw: tuple[float, float]
    poses: list[dict[str, Float]]
    follower: KeptPath
    driver: KeptBase


class KinematicRobot(Robot):
    """Moves exactly as commanded; its base starts at the origin of the map, on level ground."""

    Settings = KinematicSettings
    lacks = frozenset({"lidar", "efforts"})

    def __init__(
        self,
        settings: KinematicSettings,
        machine: Machine,
        rng: np.random.Generator | None = None,
    ) -> None:
        self._settings = settings
        self.is_ideal = not settings.noise
        self._noise = SensorNoise(machine, rng or np.random.default_rng(0))
        self._machine = machine
        self._kinematics = Kinematics(machine)
        self._q = np.array([machine.postures["scan"][name] for name in machine.arm_names])
        self._dq = np.zeros_like(self._q)
        self._jaw = self._jaw_goal = machine.gripper.open_rad
        self._jaw_held: float | None = None  # in a pause: the goal of jaws that moved
        self._follower = Follower(machine, self._q)
        self._driver = BaseDriver(machine)
        self._latch = Latch()
        self._steps = 0
        self._T_map_base = self._stand(self._driver.pose_map)
        self._sensors = {n: s for n, s in machine.sensors.items() if s.kind in ("imu", "gnss")}
        # Poses of the last three steps, whose second differences give accelerations.
        self._poses = [self._sensor_poses()] * 3

    @property
    def revision(self) -> int:  # type: ignore[override]
        return self._steps

    def keep(self) -> KeptMachine:
        """Return the state of the simulated machine."""
        return {
            "steps": self._steps,
            "arm": (self._q, self._dq),
            "jaw": (self._jaw, self._jaw_goal),
            "poses": self._poses,
            "follower": self._follower.keep(),
            "driver": self._driver.keep(),
        }

    def restore(self, kept: Mapping[str, object]) -> None:
        """Go on with a machine whose process has ended."""
        own = cast(KeptMachine, kept)
        self._steps, self._poses = own["steps"], own["poses"]
        (self._q, self._dq), (self._jaw, self._jaw_goal) = own["arm"], own["jaw"]
        self._follower.restore(own["follower"])
        self._driver.restore(own["driver"])
        self._T_map_base = self._stand(self._driver.pose_map)

    def read(self, until_s: float) -> Sequence[Observation]:
        fails_at_s = self._settings.fails_at_s
        if fails_at_s is not None and until_s >= fails_at_s:
            raise RobotError(f"the machine has not answered since {fails_at_s:.2f} s")
        observations: list[Observation] = []
        while (self._steps + 1) * _STEP_S <= until_s + 1e-9:
            observations += self._step()
        return observations

    def command(self, command: Command) -> None:
        self._latch.check(command)
        if isinstance(command, Drive):
            self._driver.command(command, self._q, arm_moves=self._follower.is_moving)
        elif isinstance(command, Follow):
            self._driver.check_at_rest()
            self._follower.follow(command.trajectory, self._q, command.stop_s)
        elif isinstance(command, LimitStop):
            self._follower.limit_stop(command.stop_s)
        elif isinstance(command, MoveJaws):
            self._jaw_held = None
            closing = command.position_rad < self._jaw
            self._jaw_goal = (
                max(command.position_rad, self._settings.jaws_stop_at)
                if closing
                else command.position_rad
            )

    def stop(self) -> None:
        self._follower.stop()
        self._driver.stop()

    def resume(self) -> None:
        self._follower.resume()

    def behind_s(self) -> float:
        return self._follower.behind_s()

    def paused(self, now_s: float) -> None:
        self._follower.pause()
        self._jaw_held, self._jaw_goal = self._jaw_goal, self._jaw

    def resumed(self, now_s: float) -> None:
        self._follower.go_on()
        if self._jaw_held is not None:
            self._jaw_goal, self._jaw_held = self._jaw_held, None

    def safe_stop(self, reason: str) -> None:
        self._latch.engage(reason)
        self._follower.give_up()
        self._driver.stop()
        self._jaw_goal, self._jaw_held = self._jaw, None

    def reset(self) -> None:
        self._latch.release(is_moving=self._follower.is_moving or self._driver.is_moving)

    def latched(self) -> str:
        return self._latch.reason

    def _step(self) -> list[Observation]:
        self._steps += 1
        self._q, self._dq = self._follower.advance(_STEP_S)
        self._T_map_base = self._stand(self._driver.advance(_STEP_S))
        most = self._machine.jaw.max_velocity * _STEP_S
        jaw_step = float(np.clip(self._jaw_goal - self._jaw, -most, most))
        self._jaw += jaw_step
        self._poses = [*self._poses[1:], self._sensor_poses()]
        stamp_s = self._steps * _STEP_S
        joints = JointSample(
            stamp_s,
            self._machine.joint_names,
            np.append(self._q, self._jaw),
            np.append(self._dq, jaw_step / _STEP_S),
            np.zeros(len(self._q) + 1),
        )
        imus = [
            self._imu(stamp_s, name)
            for name, sensor in self._sensors.items()
            if sensor.kind == "imu"
        ]
        fixes: list[Observation] = []
        if self._steps % _GNSS_EVERY == 0:
            fixes = [
                self._fix(stamp_s, name)
                for name, sensor in self._sensors.items()
                if sensor.kind == "gnss"
            ]
        samples = [*imus, *fixes, joints]
        return samples if self.is_ideal else [self._noise.on(sample) for sample in samples]

    def _stand(self, pose_map: Float) -> Float:
        """Return T_map_base on level ground at x, y and heading (3,), shape (4, 4)."""
        x, y, yaw = pose_map
        height_m = self._machine.stance.base_height_m
        return pose(about_axis(_UP, yaw), np.array([x, y, height_m]))

    def _sensor_poses(self) -> dict[str, Float]:
        frames = self._kinematics.frames(self._q)
        return {name: self._T_map_base @ frames[name] for name in self._sensors}

    def _imu(self, stamp_s: float, name: str) -> ImuSample:
        before, middle, now = (poses[name] for poses in self._poses)
        angular = log_so3(middle[:3, :3].T @ now[:3, :3]) / _STEP_S
        acceleration = (now[:3, 3] - 2 * middle[:3, 3] + before[:3, 3]) / _STEP_S**2
        force = now[:3, :3].T @ (acceleration + np.array([0.0, 0.0, GRAVITY_M_S2]))
        return ImuSample(stamp_s, name, angular, force)

    def _fix(self, stamp_s: float, name: str) -> GnssFix:
        geodetic = geodetic_from_enu(self._poses[-1][name][:3, 3], np.array(self._settings.datum))
        return GnssFix(stamp_s, name, geodetic, np.diag([1e-4, 1e-4, 4e-4]), True)
