"""The robot of simulated missions: a machine in a MuJoCo world."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import ClassVar, TypedDict, cast

import numpy as np
from executive_plugins.robot.latch import Latch
from executive_plugins.robot.mujoco.sensors.suite import KeptSensors, SensorSuite
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.site.site import make_site
from executive_plugins.robot.mujoco.site.site_copy import SiteCopy
from executive_plugins.robot.mujoco.truth.limit_log import LimitLog
from executive_plugins.robot.mujoco.truth.truth_file import read_records, write_records
from executive_plugins.robot.mujoco.truth.truth_log import TruthLog
from executive_plugins.robot.mujoco.world import CONTROL_STEP_S, KeptWorld, World
from numpy.typing import NDArray

from executive.arrays import Float
from executive.config import Settings
from executive.errors import RobotError
from executive.interfaces.facilities import Breakable, Photographer, Scene, SurveyedAside
from executive.interfaces.oracle import Witness
from executive.interfaces.robot import Robot
from executive.machine.machine import Machine
from executive.messages.command import Command, Drive, Follow, LimitStop, MoveJaws, SwitchLidars
from executive.messages.observation import Observation


class KeptRobot(TypedDict):
    """The state of the world and of the sensors, and where the stones lay."""

    world: KeptWorld
    sensors: KeptSensors
    truth: Sequence[tuple[Float, Float]]


class MujocoRobot(Robot, Scene, Photographer, SurveyedAside, Breakable, Witness):
    """Simulates the machine on a random site, with its sensors; equal seeds give equal runs.

    `world`, `truth_log` and `limit_log` hold the truth; only the sensors and the oracle read them.
    """

    Settings: ClassVar[type[Settings]] = MujocoSettings

    def __init__(
        self, settings: MujocoSettings, machine: Machine, rng: np.random.Generator
    ) -> None:
        self.settings, self._machine, self._rng = settings, machine, rng
        self._world: World | None = None
        self._latch = Latch()

    def start(self) -> None:
        """Build the site and place the machine on it; takes some seconds.

        Raises:
            ConfigError: If the site cannot be built, for example because stones do not fit.
        """
        site_rng, sensor_rng = self._rng.spawn(2)
        physics, scenario = self.settings.physics, self.settings.scenario
        site = make_site(self.settings.site, self._machine, physics, site_rng, scenario)
        legs = self.settings.legs if self.settings.footing == "on_legs" else None
        on_wheels = self.settings.footing == "on_wheels"
        valves = self._rng.spawn(1)[0] if self.settings.drive == "hydraulic" else None
        self._world = World(
            self._machine, site, physics, scenario, legs, valves, on_wheels=on_wheels
        )
        self._sensors = SensorSuite(
            self._machine, site, self.settings.sensors, self._world.model, sensor_rng
        )
        self.truth_log = TruthLog(
            self._machine, [stone.name for stone in site.stones], self._world.model
        )
        # A run may end before the first step.
        self.truth_log.step(0.0, self._world.model, self._world.data)
        self.limit_log = LimitLog(self._machine, self._world.model)
        self._world.observe(
            lambda world: self.truth_log.step(world.time_s, world.model, world.data)
        )
        self._world.observe(
            lambda world: self.limit_log.step(world.time_s, world.model, world.data)
        )

    def close(self) -> None:
        """Release the world."""
        self._world = None

    @property
    def world(self) -> World:
        """The simulated world.

        Raises:
            RobotError: If the robot has not been started.
        """
        if self._world is None:
            raise RobotError("the simulated robot is not started: call start() first")
        return self._world

    @property
    def revision(self) -> int:  # type: ignore[override]
        return 0 if self._world is None else round(self.world.time_s / CONTROL_STEP_S)

    def keep(self) -> KeptRobot:
        """Return the state of the world and of the sensors, and where the stones lay."""
        return {
            "world": self.world.keep(),
            "sensors": self._sensors.keep(),
            "truth": self.truth_log.keep(),
        }

    def restore(self, kept: Mapping[str, object]) -> None:
        """Go on with the world of a process that has ended.

        Its truth is known from then on; of what was before, where the stones lay.
        """
        own = cast(KeptRobot, kept)
        self.world.restore(own["world"])
        self._sensors.restore(own["sensors"], self.world.time_s)
        world = self.world
        self.truth_log.begin_at(world.time_s, world.model, world.data, own["truth"])

    def write_truth(self, path: Path) -> None:
        legs = self.world.legs
        stance = [] if legs is None else [legs.most_tilt_rad, legs.least_margin_m]
        records = {**self.truth_log.records(), **self.limit_log.records()}
        write_records(path, {**records, "stance": np.array(stance)})

    def read_truth(self, path: Path, zero_s: float) -> None:
        records = read_records(path)
        self.truth_log.take(records, zero_s)
        self.limit_log.take(records, zero_s)
        if self.world.legs is not None and len(records["stance"]):
            legs = self.world.legs
            legs.most_tilt_rad, legs.least_margin_m = map(float, records["stance"])

    def read(self, until_s: float) -> Sequence[Observation]:
        """Advance the world to a machine time [s]; return the observations since the last call."""
        observations: list[Observation] = []
        # Half a step of slack: until_s is a rounded multiple of the tick.
        while self.world.time_s + CONTROL_STEP_S / 2 < until_s:
            self.world.step()
            observations.extend(
                self._sensors.step(self.world.time_s, self.world.model, self.world.data)
            )
        return sorted(observations, key=lambda observation: observation.stamp_s)

    def command(self, command: Command) -> None:
        """Execute a command; see `World` for which ones are refused."""
        self._latch.check(command)
        match command:
            case Follow():
                self.world.follow(command)
            case LimitStop():
                self.world.limit_stop(command)
            case Drive():
                self.world.drive(command)
            case MoveJaws():
                self.world.move_jaws(command)
            case SwitchLidars():
                self._sensors.lidars_on = command.on

    def stop(self) -> None:
        """Slow down along the path within the acceleration limits; the jaws keep pressing."""
        self.world.stop()

    def resume(self) -> None:
        """Continue along the path that `stop` interrupted."""
        self.world.resume()

    def behind_s(self) -> float:
        return self.world.behind_s()

    def paused(self, now_s: float) -> None:
        self.world.pause()

    def resumed(self, now_s: float) -> None:
        self.world.go_on()

    def safe_stop(self, reason: str) -> None:
        """Stop for good: the path is given up, and commands are refused until `reset`."""
        self._latch.engage(reason)
        self.world.give_up()

    def reset(self) -> None:
        """Take commands again; refused while a path is under way."""
        self._latch.release(is_moving=self.world.is_moving)
        self.world.take_up()

    def latched(self) -> str:
        """Return why commands are refused; empty while they are taken."""
        return self._latch.reason

    def weaken(self, joint: str, share: float) -> None:
        """Let a drive of the arm or of the jaws have a share of its effort; 1 is sound."""
        if joint == self._machine.jaw.name:
            self.world.jaws.weaken(share)
        else:
            self.world.arm.weaken(joint, share)

    def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
        """Return ranges [m] along unit directions to ground or stones, inf for none, shape (N,)."""
        return self._sensors.cast_rays(self.world.data, origins_world, directions_world)

    def photograph(
        self, T_world_opticals: Sequence[Float], size_px: tuple[int, int], view_angle_rad: float
    ) -> Iterator[NDArray[np.uint8]]:
        """Yield pictures of the site as it is now, without the machine; see `Photographer`."""
        return self.site_now().photograph(T_world_opticals, size_px, view_angle_rad)

    def site_now(self) -> SiteCopy:
        """Return the site as it is now."""
        stones = [self.world.T_world_body(stone.name) for stone in self.world.site.stones]
        return SiteCopy(self.world.site, stones)
