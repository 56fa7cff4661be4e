"""Motion: a turn beside the machine, a sweep, and goals that no arm reaches."""

from collections.abc import Callable, Mapping
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.motion import MotionPlanner
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.request import Around, MoveRequest
from executive.testing.digest import locked
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud


def beside(machine: Machine, angle_rad: float) -> Float:
    """Return the carrying pose, turned about the machine: T_base_gripper."""
    return pose(from_rpy(0.0, 0.0, angle_rad)) @ Kinematics(machine).gripper(
        machine.posture("carry")
    )


def ground(machine: Machine) -> Cloud:
    """Return level ground about a machine whose chassis is the map's origin."""
    xy = np.random.default_rng(0).uniform(-9, 9, (30000, 2))
    return Cloud("map", np.c_[xy, np.full(len(xy), -machine.stance.base_height_m)])


def request(machine: Machine, goal: Float, obstacles: Cloud | None = None) -> MoveRequest:
    """Return a move from the carrying posture, 0.2 m straight up and 0.2 m straight down."""
    around = ground(machine) if obstacles is None else obstacles
    start = machine.posture("carry")
    return MoveRequest(start, goal.copy(), np.eye(4), 0.2, 0.2, around, None, 0.3)


class MotionInputs(TypedDict):
    """A move, a pose to reach, and postures to begin with."""

    request: MoveRequest
    T_base_gripper: Float
    seed: Float
    start: Float


class MotionExercise(Exercise[MotionPlanner, MotionInputs]):
    """A pose, a move and a sweep."""

    def inputs(self, machine: Machine) -> MotionInputs:
        return {
            "request": request(machine, beside(machine, 1.2)),
            "T_base_gripper": locked(beside(machine, 1.0)),
            "seed": locked(machine.posture("carry")),
            "start": locked(machine.posture("scan")),
        }

    def run(self, plugin: MotionPlanner, inputs: MotionInputs) -> object:
        reached = plugin.reach(inputs["T_base_gripper"], inputs["seed"])
        move = plugin.move(inputs["request"])
        return reached, move, plugin.swing(inputs["start"], 1.0, 12.0)

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[MotionPlanner], object]]:
        carry, near = machine.posture("carry"), beside(machine, 1.0)
        far = near.copy()
        far[0, 3] += 1e6
        return {
            **with_each_cloud(lambda p, c: p.move(request(machine, near, c)), "for obstacles"),
            "a goal that is not finite": lambda p: p.reach(np.full((4, 4), np.nan), carry),
            "a goal of another shape": lambda p: p.reach(np.eye(3), carry),
            "a seed of another length": lambda p: p.reach(near, np.zeros(1)),
            "a seed that is not finite": lambda p: p.reach(near, np.full(len(carry), np.nan)),
            "a goal a thousand kilometres away": lambda p: p.move(request(machine, far)),
            "a goal where the gripper is": lambda p: p.move(request(machine, beside(machine, 0.0))),
            "a sweep from a start of another length": lambda p: p.swing(np.zeros(1), 1.0, 5.0),
            "a sweep from a start that is not finite": lambda p: p.swing(
                np.full(len(carry), np.nan), 1.0, 5.0
            ),
            **with_each_cloud(
                lambda p, c: p.swing(carry, 1.0, 5.0, Around(np.eye(4), c, 0.3)), "around a sweep"
            ),
            "a sweep of no angle": lambda p: p.swing(carry, 0.0, 5.0),
        }
