"""What every placement planner must do, whatever its method."""

import numpy as np
import pytest

from executive import registry
from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.placing import PlacementPlanner
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import Stone, StoneState

BASE = pose(t=np.array([0.0, 0.0, 0.9]))
HANGING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])


class FreeMotion(MotionPlanner):
    """Reaches everything."""

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        return seed

    def move(self, request: MoveRequest) -> MotionPlan:
        raise NotImplementedError

    def swing(self, start: Float, angle_rad: float, duration_s: float) -> MotionPlan:
        raise NotImplementedError


@pytest.fixture(scope="module", params=[plugin.name for plugin in registry.installed("placing")])
def planner(request: pytest.FixtureRequest) -> PlacementPlanner:
    plugin = registry.load("placing", request.param)
    services = {"machine": load_machine("m545"), "motion": FreeMotion()}
    return plugin(plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin)))


def ground() -> Float:
    x = np.arange(-9.5, 9.5, 0.1)
    xy = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.column_stack([xy, np.zeros(len(xy))])


def stone_at(x: float, y: float) -> Stone:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(1500, 3))
    points = points / np.linalg.norm(points, axis=1)[:, None] * (0.5, 0.4, 0.3) + (x, y, 0.3)
    return Stone(1, StoneState.HELD, points, points.mean(axis=0), pose(t=points.mean(axis=0)), True)


def site() -> Segmentation:
    stones = [stone_at(5.0, y).points_map for y in (-2.5, 0.0, 2.5)]
    segments = tuple(Segment(i, p, p.mean(axis=0), np.ones(3)) for i, p in enumerate(stones))
    return Segmentation("map", segments, Cloud("map", ground()), np.array([0.0, 0.0, 1.0, 0.0]))


def test_it_is_a_placement_planner(planner: PlacementPlanner) -> None:
    assert isinstance(planner, PlacementPlanner)


def test_slots_are_no_more_than_asked_apart_and_off_the_segments(planner: PlacementPlanner) -> None:
    slots = planner.slots(site(), BASE, 5)
    assert 1 <= len(slots) <= 5
    assert [slot.id for slot in slots] == list(range(1, len(slots) + 1))
    places = np.array([slot.position_map for slot in slots])
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + 9 * np.eye(len(places))
    assert apart.min() > 1.0
    for segment in site().segments:
        assert np.linalg.norm(segment.points[:, None, :2] - places[None, :, :2], axis=2).min() > 0.5


def test_no_slots_are_asked_for_and_none_given(planner: PlacementPlanner) -> None:
    assert planner.slots(site(), BASE, 0) == ()


def test_a_stone_ends_over_its_slot_and_on_the_ground(planner: PlacementPlanner) -> None:
    stone, T_map_gripper = stone_at(5.0, 0.0), pose(HANGING, np.array([5.0, 0.0, 1.2]))
    slot = planner.slots(site(), BASE, 1)[0]
    ways = planner.plan(stone, slot, T_map_gripper, Cloud("map", ground()), BASE)
    assert ways
    moved = transform(ways[0].T_map_gripper @ inverse(T_map_gripper), stone.points_map)
    np.testing.assert_allclose(moved.mean(axis=0)[:2], slot.position_map[:2], atol=0.1)
    assert -0.02 < moved[:, 2].min() - slot.position_map[2] < 0.2
    np.testing.assert_allclose(
        ways[0].T_map_object,
        ways[0].T_map_gripper @ inverse(T_map_gripper) @ stone.T_map_object,
        atol=1e-9,
    )
