"""A robot: measurements at rest, a motion, stops, and commands that cannot be followed."""

from collections.abc import Callable, Mapping, Sequence
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.errors import DataError, RobotError
from executive.interfaces.robot import Robot
from executive.machine.machine import Machine
from executive.messages.command import Follow, MoveJaws
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.messages.trajectory import JointTrajectory
from executive.testing.exercise import Exercise, RefusedError

TICK_S = 0.05


def newest_joints(observations: Sequence[Observation]) -> JointSample | None:
    """Return the newest joint sample, or None."""
    samples = [one for one in observations if isinstance(one, JointSample)]
    return samples[-1] if samples else None


def arm_of(arm: Sequence[str], sample: JointSample) -> Float:
    """Return the arm's positions of a sample, in the order of the names, shape (n,)."""
    return np.array([sample.of(name)[0] for name in arm])


def turn(
    arm: tuple[str, ...], joint: str, start: Float, angle_rad: float, duration_s: float
) -> JointTrajectory:
    """Return a turn of one joint from rest to rest: a cosine of the time."""
    times = np.linspace(0.0, duration_s, 50)
    share = 0.5 - 0.5 * np.cos(np.pi * times / duration_s)
    rate = 0.5 * np.pi / duration_s * np.sin(np.pi * times / duration_s)
    rate[[0, -1]] = 0.0
    along = np.zeros(len(start))
    along[arm.index(joint)] = angle_rad
    return JointTrajectory(arm, times, start + share[:, None] * along, rate[:, None] * along)


class RobotInputs(TypedDict):
    """The joints to command, and a command for the jaws."""

    arm: tuple[str, ...]
    joint: str
    jaws: MoveJaws


class RobotExercise(Exercise[Robot, RobotInputs]):
    """Ten ticks at rest, ten along a turn of the cabin, ten after a stop; then a safe stop."""

    may_raise = (RobotError, DataError)

    def inputs(self, machine: Machine) -> RobotInputs:
        return {
            "arm": machine.arm_names,
            "joint": machine.turn_joint,
            "jaws": MoveJaws(0.5 * machine.jaw.open_rad, 1000.0),
        }

    def run(self, plugin: Robot, inputs: RobotInputs) -> object:
        measured: list[Observation] = []

        def ticks(first: int, last: int) -> None:
            for k in range(first, last):
                measured.extend(plugin.read(k * TICK_S))

        ticks(1, 11)
        sample = newest_joints(measured)
        if sample is not None:
            start = arm_of(inputs["arm"], sample)
            plugin.command(Follow(turn(inputs["arm"], inputs["joint"], start, 0.1, 2.0)))
        try:
            plugin.command(inputs["jaws"])
        except RobotError as error:
            raise RefusedError(str(error)) from error
        ticks(11, 21)
        plugin.stop()
        plugin.resume()
        plugin.stop()
        ticks(21, 31)
        plugin.safe_stop("the end of the exercise")
        return measured, plugin.latched()

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[Robot], object]]:
        def followed(trajectory: Callable[[Float], JointTrajectory]) -> Callable[[Robot], object]:
            def call(robot: Robot) -> object:
                sample = newest_joints(robot.read(2 * TICK_S))
                if sample is not None:
                    robot.command(Follow(trajectory(arm_of(machine.arm_names, sample))))
                return robot.read(4 * TICK_S)

            return call

        def strangers(start: Float) -> JointTrajectory:
            return JointTrajectory(
                ("joint_of_another_machine",), np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1))
            )

        return {
            "the same time twice": lambda robot: (robot.read(0.1), robot.read(0.1)),
            "a time that has passed": lambda robot: (robot.read(0.1), robot.read(0.05)),
            "a stop while nothing moves": lambda robot: (robot.stop(), robot.read(0.1)),
            "a second safe stop": lambda robot: (
                robot.safe_stop("the first"),
                robot.safe_stop("the second"),
                robot.latched(),
            ),
            "a reset of nothing": lambda robot: (robot.reset(), robot.latched()),
            "a resume of nothing": lambda robot: (robot.resume(), robot.read(0.1)),
            "a path that begins elsewhere": followed(
                lambda q: turn(machine.arm_names, machine.turn_joint, q + 1.0, 0.1, 1.0)
            ),
            "a path of unknown joints": followed(strangers),
        }
