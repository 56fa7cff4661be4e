"""All sensors of the machine: when each measures, and when its observations arrive."""

import math
from collections.abc import Callable, Mapping
from typing import TypedDict

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.sensors.dropout import check_dropouts, is_silent
from executive_plugins.robot.mujoco.sensors.encoders import JointEncoders
from executive_plugins.robot.mujoco.sensors.gnss import Antenna
from executive_plugins.robot.mujoco.sensors.imu import MountedImu
from executive_plugins.robot.mujoco.sensors.lidar import SpinningLidar
from executive_plugins.robot.mujoco.sensors.pose_history import PoseHistory
from executive_plugins.robot.mujoco.sensors.settings import SensorSettings
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh, joined
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.site_scene import SiteScene

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders, Gnss, Imu, Lidar, Sensor
from executive.messages.observation import Observation

Measure = Callable[[float, mujoco.MjData], Observation | None]
_EPSILON = 1e-6  # tolerance for rounding of times, which are sums of steps


class KeptSensors(TypedDict):
    """The states of the random generators and of the inertial biases."""

    generators: list[Mapping[str, object]]
    biases: list[tuple[Float, Float]]


class SensorSuite:
    """The sensors of the machine in a simulated world; each has its own random generator.

    `step` is called after every control step and returns observations after their latency. Lidars
    measure only while `lidars_on`, in whole revolutions.
    """

    def __init__(
        self,
        machine: Machine,
        site: Site,
        settings: SensorSettings,
        model: mujoco.MjModel,
        rng: np.random.Generator,
    ) -> None:
        check_dropouts(settings.dropouts, machine.sensors)
        self.scene = SiteScene(site)
        self.lidars_on = False
        self._settings = settings
        self._stones = tuple(stone.name for stone in site.stones)
        self._lidars = [sensor for sensor in machine.sensors.values() if isinstance(sensor, Lidar)]
        span_s = max((1 / lidar.rate_hz for lidar in self._lidars), default=0.0)
        people = {person.name: person.mesh() for person in site.people}
        self._history = PoseHistory(model, (*machine.links, *self._stones, *people), span_s)
        self._skin = link_meshes(machine) | people
        self._sensors: list[tuple[Sensor, Measure]] = []
        self._imus: list[MountedImu] = []
        self._generators = rng.spawn(len(machine.sensors))
        for sensor, own_rng in zip(machine.sensors.values(), self._generators, strict=True):
            self._sensors.append((sensor, self._measure(sensor, machine, model, own_rng)))
        self._last_s = 0.0
        self._on_the_way: list[tuple[float, Observation]] = []

    def _measure(
        self, sensor: Sensor, machine: Machine, model: mujoco.MjModel, rng: np.random.Generator
    ) -> Measure:
        match sensor:
            case Lidar():
                stride = self._settings.azimuth_stride
                lidar = SpinningLidar(sensor, stride, self._skin, self.scene, self._history, rng)
                return lambda time_s, _: lidar.scan(time_s)
            case Imu():
                self._imus.append(MountedImu(sensor, model, rng))
                return self._imus[-1].sample
            case Gnss():
                return Antenna(sensor, np.array(self._settings.datum), model, rng).sample
            case Encoders():
                return JointEncoders(sensor, machine, model, rng).sample

    def keep(self) -> KeptSensors:
        """Return the states of the random generators and of the inertial biases.

        What was on its way, and a revolution that had begun, are lost with the process.
        """
        return {
            "generators": [rng.bit_generator.state for rng in self._generators],
            "biases": [imu.biases for imu in self._imus],
        }

    def restore(self, kept: KeptSensors, time_s: float) -> None:
        """Take back what `keep` returned, at a time of the world [s]."""
        for rng, state in zip(self._generators, kept["generators"], strict=True):
            rng.bit_generator.state = state
        for imu, biases in zip(self._imus, kept["biases"], strict=True):
            imu.begin_again(biases)
        self._last_s = time_s
        self._on_the_way.clear()
        self._history.clear()

    def step(self, time_s: float, model: mujoco.MjModel, data: mujoco.MjData) -> list[Observation]:
        """Measure what is due after a control step; return what has arrived, in order of stamps."""
        # mj_step leaves poses and velocities one integration step behind the coordinates.
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        self._follow(time_s, data)
        for sensor, measure in self._sensors:
            if self._is_due(sensor, time_s):
                observation = measure(time_s, data)
                if observation is not None and not is_silent(
                    self._settings.dropouts, sensor.name, time_s
                ):
                    self._on_the_way.append((time_s + sensor.latency_s, observation))
        self._last_s = time_s
        return self._arrived(time_s)

    def cast_rays(
        self, data: mujoco.MjData, origins_world: Float, directions_world: Float
    ) -> Float:
        """Return ranges to the site as it is now, see `executive.interfaces.robot.Scene`."""
        self.scene.update(self._stone_poses(data))
        return self.scene.cast_rays(origins_world, directions_world)

    def _follow(self, time_s: float, data: mujoco.MjData) -> None:
        """Record motion while the lidars are on; update the scene when a revolution ends."""
        if not self.lidars_on:
            self._history.clear()
            return
        self._history.push(time_s, data)
        if any(self._is_due(lidar, time_s) for lidar in self._lidars):
            self.scene.update(self._stone_poses(data))

    def _stone_poses(self, data: mujoco.MjData) -> list[Float]:
        bodies = [data.body(name) for name in self._stones]
        return [pose(body.xmat.reshape(3, 3), body.xpos) for body in bodies]

    def _is_due(self, sensor: Sensor, time_s: float) -> bool:
        """Return whether a period of a sensor ends in this control step.

        Periods are counted from time 0.
        """
        rate_hz = sensor.rate_hz
        if math.floor(time_s * rate_hz + _EPSILON) == math.floor(self._last_s * rate_hz + _EPSILON):
            return False
        if not isinstance(sensor, Lidar):
            return True
        is_whole = self._history.oldest_s <= time_s - 1 / sensor.rate_hz + _EPSILON
        return is_whole and not is_silent(self._settings.dropouts, sensor.name, time_s)

    def _arrived(self, time_s: float) -> list[Observation]:
        arrived = [
            observation for at_s, observation in self._on_the_way if at_s <= time_s + _EPSILON
        ]
        self._on_the_way = [item for item in self._on_the_way if item[0] > time_s + _EPSILON]
        return sorted(arrived, key=lambda observation: observation.stamp_s)


def link_meshes(machine: Machine) -> dict[str, Mesh]:
    """Return one mesh per link, in the link's frame, for all links that have shapes."""
    return {
        name: joined([hull_mesh(shape.vertices) for shape in link.shapes])
        for name, link in machine.links.items()
        if link.shapes
    }
