"""Objects: boulders that are seen, held, moved and seen again, and segments of nothing."""

from collections.abc import Callable, Mapping
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.errors import ConfigError, DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.objects import ObjectDatabase
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.messages.stone import StoneState
from executive.testing.digest import locked
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud

T_GRASP = pose(from_rpy(0.1, 1.5, 0.3), np.array([5.0, 0.1, 1.0]))
T_RELEASE = pose(from_rpy(0.0, 1.4, 1.9), np.array([-1.0, 6.0, 1.2]))
IN_MEMORY = ":memory:"


def boulder(x: float, y: float) -> Segment:
    """Return a segment of an ellipsoid about (x, y, 0.3)."""
    d = np.random.default_rng(0).normal(size=(2000, 3))
    points = 0.5 * d / np.linalg.norm(d, axis=1)[:, None] * [1, 0.8, 0.7] + [x, y, 0.3]
    return Segment(0, points, points.mean(axis=0), np.array([1.0, 0.8, 0.7]))


def _segment(points: Float) -> Segment:
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    return Segment(0, points.copy(), middle, np.zeros(3))


class ObjectsInputs(TypedDict):
    """Two boulders, and what happens to one of them."""

    segments: tuple[Segment, ...]
    map_cloud: Cloud
    centre_map: Float
    T_grasp: Float
    T_release: Float
    T_map_map: Float


class ObjectsExercise(Exercise[ObjectDatabase, ObjectsInputs]):
    """Two stones, one of which is moved and seen again."""

    may_raise = (DataError, ConfigError)

    def inputs(self, machine: Machine) -> ObjectsInputs:
        return {
            "segments": (boulder(5, 0), boulder(0, 4)),
            "map_cloud": Cloud("map", np.vstack([boulder(5, 0).points, boulder(0, 4).points])),
            "centre_map": locked([0.0, 4.0, 0.3]),
            "T_grasp": locked(T_GRASP),
            "T_release": locked(T_RELEASE),
            "T_map_map": locked(pose(from_rpy(0, 0, 0.2), np.array([0.1, 0, 0]))),
        }

    def run(self, plugin: ObjectDatabase, inputs: ObjectsInputs) -> object:
        plugin.open(IN_MEMORY)
        first = plugin.observe(inputs["segments"], 1.0, False)
        number = first[0].id
        held = plugin.grasp(number, inputs["T_grasp"], 2.0)
        moved = plugin.release(number, inputs["T_release"], 3.0, StoneState.PLACED)
        aside = plugin.set_state(first[1].id, StoneState.SET_ASIDE, 3.5)
        aligned = plugin.realign(number, inputs["T_map_map"], 4.0, "overlap 0.9")
        again = plugin.observe(inputs["segments"], 5.0, True)
        looks = (
            plugin.surroundings(inputs["map_cloud"]),
            plugin.unexplained(inputs["map_cloud"], number, 2.0),
            plugin.surface_within(inputs["centre_map"], 2.0),
        )
        changes = (first, held, moved, aside, aligned, again)
        return changes, looks, plugin.stones(), plugin.stone(number), plugin.history(number)

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[ObjectDatabase], object]]:
        def seen(database: ObjectDatabase, segment: Segment) -> object:
            database.open(IN_MEMORY)
            return database.observe([segment], 1.0, False), database.stones()

        def with_one(
            call: Callable[[ObjectDatabase], object],
        ) -> Callable[[ObjectDatabase], object]:
            def run(database: ObjectDatabase) -> object:
                database.open(IN_MEMORY)
                database.observe([boulder(5, 0)], 1.0, False)
                return call(database), database.stones()

            return run

        nowhere = np.full((4, 4), np.nan)
        return {
            **with_each_cloud(
                lambda database, cloud: seen(database, _segment(cloud.points)), "as segment"
            ),
            **with_each_cloud(
                lambda database, cloud: with_one(lambda d: d.surroundings(cloud))(database),
                "for a map",
            ),
            **with_each_cloud(
                lambda database, cloud: with_one(lambda d: d.unexplained(cloud, 1, 2.0))(database),
                "to explain",
            ),
            "a stone that is not known": with_one(lambda d: d.grasp(99, T_GRASP, 2.0)),
            "a grasp that is not finite": with_one(lambda d: d.grasp(1, nowhere, 2.0)),
            "a release of what is not held": with_one(
                lambda d: d.release(1, T_RELEASE, 2.0, StoneState.PLACED)
            ),
            "a correction of another shape": with_one(lambda d: d.realign(1, np.eye(3), 2.0)),
        }
