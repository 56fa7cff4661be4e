"""Slots on sites that are drawn by hand, and stones set down on them."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial import cKDTree

from executive.errors import DataError
from executive.geometry.convex import depth_inside, half_spaces, volume_and_centroid
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis
from executive.machine.jaw_clearance import release_angles
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot

UP = np.array([0.0, 0.0, 1.0])
BASE = pose(t=np.array([0.0, 0.0, 0.9]))


def places(planner, segmentation, count: int = 7, T_map_base=BASE) -> np.ndarray:
    return np.array(
        [slot.position_map for slot in planner.slots(segmentation, T_map_base, count)]
    ).reshape(-1, 3)


def gaps(xy: np.ndarray) -> np.ndarray:
    return cKDTree(xy).query(xy, k=2)[0][:, 1]


def test_an_empty_site_has_equally_spaced_slots_on_one_arc(
    planner_of: Callable, site: tuple
) -> None:
    _, ground, segmented, _ = site
    p = places(planner_of(spacing_m=1.9), segmented(ground()))
    assert len(p) == 7
    np.testing.assert_allclose(np.hypot(p[:, 0], p[:, 1]), 6.0)
    np.testing.assert_allclose(gaps(p[:, :2]), gaps(p[:, :2])[0], atol=1e-6)
    assert gaps(p[:, :2]).min() >= 1.9 - 1e-9


def test_slots_keep_off_segments(planner_of: Callable, site: tuple) -> None:
    block, ground, segmented, _ = site
    stones = [block((6.0 * np.cos(a), 6.0 * np.sin(a))) for a in np.linspace(-1.2, 1.2, 6)]
    p = places(planner_of(clearance_m=1.2), segmented(ground(), *stones))
    assert len(p) == 7
    assert cKDTree(np.concatenate(stones)[:, :2]).query(p[:, :2])[0].min() >= 1.2


def test_slots_lie_on_the_ground(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    np.testing.assert_allclose(
        places(planner_of(), segmented(ground(height_m=-0.35)))[:, 2], -0.35, atol=1e-6
    )


def test_unknown_steep_and_rough_ground_holds_no_slot(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    points = ground()
    rng = np.random.default_rng(0)
    unknown = points[points[:, 1] > 0]
    steep = np.where(points[:, 1] < 0, -0.5 * points[:, 1], 0.0)[:, None] * UP + points
    rough = np.where(points[:, 1] < 0, rng.normal(0, 0.2, len(points)), 0.0)[:, None] * UP + points
    for bad in (unknown, steep, rough):
        p = places(planner_of(), segmented(bad))
        assert len(p)
        assert p[:, 1].min() > 0


def test_fewer_places_than_asked_give_fewer_slots(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    points = ground()
    patch = points[(np.linalg.norm(points[:, :2] - (6.0, 0.0), axis=1) < 0.9)]
    assert len(places(planner_of(), segmented(patch))) == 1
    assert len(places(planner_of(), segmented(np.empty((0, 3))))) == 0


def test_more_than_a_row_holds_fills_further_rows(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    p = places(planner_of(sector_rad=1.5, radii_m=(6.0, 7.9, 4.1)), segmented(ground()), count=8)
    assert len(p) == 8
    assert len(np.unique(np.hypot(p[:, 0], p[:, 1]).round(6))) > 1
    assert gaps(p[:, :2]).min() >= 1.9 - 1e-9


@pytest.mark.parametrize(
    ("is_free", "prefer", "radius_m"),
    [
        (False, "by_base", 6.0),
        (True, "by_base", 4.5),
        (True, "given", 6.0),
        (False, "nearest", 4.5),
        (False, "capacity", 4.5),
    ],
)
def test_a_machine_that_may_tip_has_its_slots_near(
    planner_of: Callable,
    machine: Machine,
    site: tuple,
    is_free: bool,
    prefer: str,
    radius_m: float,
) -> None:
    _, ground, segmented, _ = site
    stance = machine.stance.model_copy(update={"is_free": is_free})
    planner = planner_of(prefer=prefer, radii_m=(6.0, 5.0, 4.5))
    planner._machine = machine.model_copy(update={"stance": stance})
    p = places(planner, segmented(ground()))
    assert len(p) == 7
    np.testing.assert_allclose(np.hypot(p[:, 0], p[:, 1]), radius_m)


def test_places_near_a_machine_that_may_tip_are_used_though_farther_ones_would_do_alone(
    planner_of: Callable, site: tuple
) -> None:
    block, ground, segmented, _ = site
    beside = [block((4.5 * np.cos(a), 4.5 * np.sin(a))) for a in (-0.9, 0.9, 2.0, 3.0, 4.2)]
    near = {}
    for prefer in ("given", "nearest"):
        planner = planner_of(prefer=prefer, radii_m=(7.5, 4.5))
        p = places(planner, segmented(ground(), *beside))
        assert len(p) == 7
        near[prefer] = np.hypot(p[:, 0], p[:, 1]) < 5.0
    assert not near["given"].any()
    first, last = near["nearest"][0], near["nearest"][-1]
    assert first
    assert not last


def test_a_heavy_stone_gets_a_place_where_a_machine_that_may_tip_lifts_it(
    planner_of: Callable, machine: Machine, site: tuple
) -> None:
    """Without the masses of the stones the first place is the one nearest the front."""
    block, ground, segmented, _ = site
    heavy = block((7.5, 1.5), height_m=1.0, half_m=0.5)  # 2.7 t
    points = ground()
    beside = points[np.abs(np.arctan2(points[:, 1], points[:, 0]) - np.pi / 2) < 0.4]
    behind = points[np.abs(np.arctan2(points[:, 1], points[:, 0]) + 3.0) < 0.4]
    segmentation = segmented(np.vstack([beside, behind]), heavy)
    found = {}
    for prefer in ("nearest", "capacity"):
        planner = planner_of(prefer=prefer, radii_m=(5.0,))
        planner._machine = machine
        found[prefer] = places(planner, segmentation, count=1)[0]
    assert found["nearest"][1] > 4.0
    assert found["capacity"][0] < -4.0


def test_slots_by_capacity_say_which_stone_each_is_meant_for(
    planner_of: Callable, machine: Machine, site: tuple
) -> None:
    block, ground, segmented, _ = site
    left, right = block((4.0, 4.0)), block((4.0, -4.0), half_m=0.3)
    planner = planner_of(prefer="capacity", radii_m=(6.0,))
    planner._machine = machine
    slots = planner.slots(segmented(ground(), left, right), BASE, 3)
    for slot, stone in zip(slots, (left, right), strict=False):
        np.testing.assert_allclose(slot.meant_for_map, stone.mean(axis=0))
        assert np.sign(slot.position_map[1]) == np.sign(stone[:, 1].mean())
    assert slots[2].meant_for_map is None


def test_slots_out_of_reach_are_not_offered(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    assert len(places(planner_of(reach_m=(2.0, 5.0), radii_m=(6.0,)), segmented(ground()))) == 0


def test_slots_turn_and_move_with_the_machine(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    T = pose(about_axis(UP, 0.8), np.array([0.5, -0.4, 0.0]))
    here, there = (places(planner_of(), segmented(ground()), 5, M) for M in (BASE, T @ BASE))
    np.testing.assert_allclose(transform(T, here)[:, :2], there[:, :2], atol=1e-6)


def test_the_same_site_has_the_same_slots(planner_of: Callable, site: tuple) -> None:
    block, ground, segmented, _ = site
    scene = segmented(ground(), block((5.0, 2.0)))
    np.testing.assert_array_equal(places(planner_of(), scene), places(planner_of(), scene))


def test_a_stone_is_set_down_over_its_slot_just_above_the_ground(
    planner_of: Callable, site: tuple
) -> None:
    _, ground, _, held = site
    stone, T_map_gripper = held((5.0, -2.0))
    slot = Slot(1, np.array([0.0, 6.0, 0.0]))
    ways = planner_of(drop_m=0.05).plan(stone, slot, T_map_gripper, Cloud("map", ground()), BASE)
    assert ways
    for way in ways:
        moved = transform(way.T_map_gripper @ inverse(T_map_gripper), stone.points_map)
        _, centre = volume_and_centroid(moved)
        np.testing.assert_allclose(centre[:2], slot.position_map[:2], atol=1e-6)
        assert moved[:, 2].min() == pytest.approx(0.05, abs=0.01)
        T_map_map = way.T_map_gripper @ inverse(T_map_gripper)
        np.testing.assert_allclose(way.T_map_object, T_map_map @ stone.T_map_object, atol=1e-9)


@pytest.mark.parametrize(("at", "turn_rad"), [((6.0, 0.0), np.pi / 2), ((0.0, -6.0), np.pi)])
def test_a_stone_keeps_its_attitude_to_gravity_and_turns_with_the_cabin_first(
    planner_of: Callable, site: tuple, at: tuple[float, float], turn_rad: float
) -> None:
    _, ground, _, held = site
    stone, T_map_gripper = held(at)
    ways = planner_of().plan(
        stone, Slot(1, np.array([0.0, 6.0, 0.0])), T_map_gripper, Cloud("map", ground()), BASE
    )
    motions = [way.T_map_gripper @ inverse(T_map_gripper) for way in ways]
    np.testing.assert_allclose([T[2, 2] for T in motions], 1.0)
    np.testing.assert_allclose(motions[0][:3, :3], about_axis(UP, turn_rad), atol=1e-6)


def test_a_model_without_its_foot_is_not_driven_into_the_ground(
    planner_of: Callable, site: tuple
) -> None:
    _, ground, _, held = site
    stone, T_map_gripper = held((5.0, -2.0))
    known = stone.points_map[stone.points_map[:, 2] > 0.12]
    seen = type(stone)(3, stone.state, known, known.mean(axis=0), stone.T_map_object, True)
    way = planner_of(drop_m=0.05).plan(
        seen, Slot(1, np.array([0.0, 6.0, 0.0])), T_map_gripper, Cloud("map", ground()), BASE
    )[0]
    whole = transform(way.T_map_gripper @ inverse(T_map_gripper), stone.points_map)
    assert whole[:, 2].min() == pytest.approx(0.05, abs=0.01)


def test_opening_jaws_and_stone_keep_off_the_neighbours(
    planner_of: Callable, site: tuple, machine: Machine
) -> None:
    block, ground, _, held = site
    stone, T_map_gripper = held((5.0, -2.0))
    neighbours = np.concatenate([block((-1.4, 6.0)), block((1.4, 6.0))])
    cloud = Cloud("map", np.concatenate([ground(), neighbours]))
    ways = planner_of().plan(stone, Slot(1, np.array([0.0, 6.0, 0.0])), T_map_gripper, cloud, BASE)
    assert ways
    for way in ways:
        local = transform(inverse(way.T_map_gripper), neighbours)
        at_hold = transform(inverse(T_map_gripper), stone.points_map)
        for angle in release_angles(machine.gripper, at_hold, way.T_map_gripper[2, :3]):
            for hulls in machine.gripper.hulls(angle).values():
                assert (
                    max(float(depth_inside(half_spaces(hull), local).max()) for hull in hulls)
                    < 0.02
                )
        moved = transform(way.T_map_gripper @ inverse(T_map_gripper), stone.points_map)
        assert cKDTree(neighbours).query(moved)[0].min() > 0.1


def test_a_taken_slot_has_no_way(planner_of: Callable, site: tuple) -> None:
    block, ground, _, held = site
    stone, T_map_gripper = held((5.0, -2.0))
    cloud = Cloud("map", np.concatenate([ground(), block((0.0, 6.0))]))
    assert (
        planner_of().plan(stone, Slot(1, np.array([0.0, 6.0, 0.0])), T_map_gripper, cloud, BASE)
        == ()
    )


def test_a_slot_out_of_reach_has_no_way(planner_of: Callable, site: tuple) -> None:
    _, ground, _, held = site
    stone, T_map_gripper = held((5.0, -2.0))
    far = Slot(1, np.array([0.0, 9.4, 0.0]))
    assert planner_of().plan(stone, far, T_map_gripper, Cloud("map", ground()), BASE) == ()


def test_a_cloud_in_another_frame_is_refused(planner_of: Callable, site: tuple) -> None:
    stone, T_map_gripper = site[3]((5.0, -2.0))
    with pytest.raises(DataError, match="frame 'map', got 'drone'"):
        planner_of().plan(
            stone, Slot(1, np.zeros(3)), T_map_gripper, Cloud("drone", np.zeros((1, 3))), BASE
        )


@pytest.mark.parametrize("reach_m", [(2.0, 9.0), (7.0, 9.0)])
def test_a_slot_with_a_pose_has_that_placement_or_none(
    planner_of: Callable, site: tuple, reach_m: tuple[float, float]
) -> None:
    _, ground, _, held = site
    stone, T_map_gripper = held((5.0, -2.0))
    T_rest = pose(about_axis(UP, 0.4), np.array([0.0, 6.0, 0.31]))
    slot = Slot(1, np.array([0.0, 6.0, 0.0]), None, 0.0, T_rest)
    planner = planner_of(reach_m, drop_m=0.05)
    ways = planner.plan(stone, slot, T_map_gripper, Cloud("map", ground()), BASE)
    assert len(ways) == (reach_m[0] < 6.0)
    for way in ways:
        moved = way.T_map_gripper @ inverse(T_map_gripper) @ stone.T_map_object
        np.testing.assert_allclose(moved, pose(t=0.05 * UP) @ T_rest, atol=1e-9)
        np.testing.assert_allclose(way.T_map_object, T_rest, atol=1e-9)
