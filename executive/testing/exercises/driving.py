"""Driving: a way ahead over level ground, and requests that no machine can follow."""

from collections.abc import Callable, Mapping
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.interfaces.driving import DrivePlanner
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.drive import BasePath, DriveRequest
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud


def standing(machine: Machine) -> Float:
    """Return T_map_base at the origin of level ground at height 0, shape (4, 4)."""
    return pose(t=np.array([0.0, 0.0, machine.stance.base_height_m]))


def level_ground() -> Cloud:
    """Return level ground about the origin."""
    xy = np.random.default_rng(0).uniform(-25, 25, (40000, 2))
    return Cloud("map", np.c_[xy, np.zeros(len(xy))])


def ahead(machine: Machine, way_m: float, ground: Cloud | None = None) -> DriveRequest:
    """Return a request to drive straight ahead, or back for a negative way."""
    goal = np.array([[way_m, 0.0, 0.0]])
    return DriveRequest(standing(machine), goal, level_ground() if ground is None else ground)


def line(way_m: float) -> BasePath:
    """Return a straight path from the origin along x."""
    along = np.linspace(0.0, way_m, 100)
    nothing = np.zeros(100)
    return BasePath(np.c_[along, nothing, nothing], along, nothing, np.ones(100, dtype=np.int64))


class DrivingInputs(TypedDict):
    """A drive to plan, a path to follow and where the machine stands."""

    request: DriveRequest
    path: BasePath
    T: Float


class DrivingExercise(Exercise[DrivePlanner, DrivingInputs]):
    """A plan, and two ticks of steering."""

    may_raise = (DataError,)

    def inputs(self, machine: Machine) -> DrivingInputs:
        return {"request": ahead(machine, 8.0), "path": line(8.0), "T": standing(machine)}

    def run(self, plugin: DrivePlanner, inputs: DrivingInputs) -> object:
        first = plugin.steer(inputs["path"], 0.0, inputs["T"])
        second = plugin.steer(inputs["path"], first.along_m, inputs["T"])
        return plugin.plan(inputs["request"]), first, second

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[DrivePlanner], object]]:
        far = np.array([[1e6, 0.0, 0.0]])
        nowhere = np.full((1, 3), np.nan)
        ground = level_ground()
        return {
            **with_each_cloud(lambda p, c: p.plan(ahead(machine, 8.0, c)), "for the surroundings"),
            "a goal a thousand kilometres away": lambda p: p.plan(
                DriveRequest(standing(machine), far, ground)
            ),
            "a goal where the machine stands": lambda p: p.plan(ahead(machine, 0.0)),
            "a goal that is not finite": lambda p: p.plan(
                DriveRequest(standing(machine), nowhere, ground)
            ),
            "a pose that is not finite": lambda p: p.steer(line(8.0), 0.0, np.full((4, 4), np.nan)),
            "a length beyond the path's end": lambda p: p.steer(line(8.0), 99.0, standing(machine)),
        }
