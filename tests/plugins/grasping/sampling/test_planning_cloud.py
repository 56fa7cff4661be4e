"""What the gripper is tried on."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud, build_planning_cloud

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis

SPACING_M = 0.05
UP = np.array([0.0, 0.0, 1.0])


def build(stone: np.ndarray, cloud: np.ndarray, into_soil_m: float = 0.0) -> PlanningCloud:
    rng = np.random.default_rng(0)
    return build_planning_cloud(stone, cloud, 1.3, SPACING_M, rng, into_soil_m=into_soil_m)


def test_the_stone_keeps_its_volume_and_centre(make_box: Callable, make_field: Callable) -> None:
    box = make_box((1.2, 0.8, 0.6))
    scene = build(box, np.concatenate([box, make_field(without=np.array([0.6, 0.4]))]))
    assert scene.volume_m3 == pytest.approx(1.2 * 0.8 * 0.6, rel=0.08)
    np.testing.assert_allclose(transform(scene.T_map_plan, scene.centre), [0, 0, 0.3], atol=0.02)


def test_points_of_the_stone_in_the_map_are_not_obstacles(
    make_box: Callable, make_field: Callable
) -> None:
    box = make_box((1.2, 0.8, 0.6))
    scene = build(box, np.concatenate([box + 0.01, make_field()]))
    others = transform(scene.T_map_plan, scene.points[~scene.is_target])
    assert others[:, 2].max() < 0.1


def test_a_neighbour_at_0_3_m_is_an_obstacle_and_none_of_the_stone(
    make_box: Callable, make_field: Callable
) -> None:
    box = make_box((0.8, 0.8, 0.6))
    neighbour = box + (1.1, 0.0, 0.0)
    scene = build(box, np.concatenate([box, neighbour, make_field()]))
    stone = transform(scene.T_map_plan, scene.stone)
    others = transform(scene.T_map_plan, scene.points[~scene.is_target])
    assert stone[:, 0].max() < 0.45
    assert (others[:, 2] > 0.3).any()


def test_soil_lies_as_much_lower_as_the_tips_may_go_into_it_and_neighbours_do_not(
    make_box: Callable, make_field: Callable
) -> None:
    box = make_box((0.8, 0.8, 0.6))
    rough = make_field() + np.random.default_rng(1).normal(0.0, 0.01, (len(make_field()), 3))
    cloud = np.concatenate([box, box + (1.1, 0.0, 0.0), rough])
    hard, soft = build(box, cloud), build(box, cloud, into_soil_m=0.1)
    np.testing.assert_array_equal(soft.stone, hard.stone)
    lower_m = (hard.points - soft.points)[:, 2]
    height_m = transform(hard.T_map_plan, hard.points)[:, 2]
    assert lower_m[~hard.is_target & (np.abs(height_m) < 0.03)] == pytest.approx(0.1)
    assert lower_m[~hard.is_target & (height_m > 0.1)] == pytest.approx(0.0)


def test_the_foot_that_segmentation_left_belongs_to_the_stone(
    make_box: Callable, make_field: Callable
) -> None:
    box = make_box((0.8, 0.8, 0.6))
    known = box[box[:, 2] > 0.1]
    scene = build(known, np.concatenate([box, make_field(without=np.array([0.4, 0.4]))]))
    assert transform(scene.T_map_plan, scene.stone)[:, 2].min() < 0.08


def test_the_body_stands_on_the_ground(make_box: Callable, make_field: Callable) -> None:
    box = make_box((0.8, 0.8, 0.6))
    scene = build(box[box[:, 2] > 0.1], np.concatenate([box[box[:, 2] > 0.1], make_field()]))
    assert transform(scene.T_map_plan, scene.body())[:, 2].min() == pytest.approx(0.0, abs=0.03)


@pytest.mark.parametrize("foot", [1.0, 0.5, 0.1])
def test_a_foot_that_is_drawn_in_is_smaller_and_the_stone_above_it_stays(
    make_box: Callable, make_field: Callable, foot: float
) -> None:
    """A box of 0.8 m whose lowest decimetre is not seen."""
    box = make_box((0.8, 0.8, 0.6))
    scene = build(box[box[:, 2] > 0.1], np.concatenate([box[box[:, 2] > 0.1], make_field()]))
    body = transform(scene.T_map_plan, scene.body(foot))
    on_ground = body[body[:, 2] < 0.03]
    assert np.ptp(on_ground[:, :2], axis=0) == pytest.approx([0.8 * foot] * 2, abs=0.06)
    assert np.ptp(body[body[:, 2] > 0.1, :2], axis=0) == pytest.approx([0.8, 0.8], abs=0.06)
    assert on_ground[:, :2].mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.05)


def test_a_stone_that_touches_no_ground_keeps_its_shape(make_box: Callable) -> None:
    scene = build(make_box((0.8, 0.8, 0.6)) + (0.0, 0.0, 1.0), make_box((0.8, 0.8, 0.6)))
    lowest = scene.stone[:, 2] - scene.ground.height(scene.stone[:, :2])
    assert lowest.min() > 0.15
    assert scene.body(0.5)[:, 2].min() == pytest.approx(scene.stone[:, 2].min())


def test_normals_point_out_of_the_stone(make_box: Callable, make_field: Callable) -> None:
    box = make_box((1.2, 0.8, 0.6))
    scene = build(box, np.concatenate([box, make_field()]))
    assert (np.einsum("ij,ij->i", scene.normals, scene.stone - scene.centre) > 0).all()


def test_a_turned_and_shifted_scene_gives_the_same_numbers(
    make_box: Callable, make_field: Callable
) -> None:
    rng = np.random.default_rng(5)
    box = make_box((1.2, 0.8, 0.6)) * rng.uniform(0.9, 1.0, 3) + rng.normal(0, 0.005, 3)
    box = box[rng.random(len(box)) < np.where(box[:, 0] > 0, 0.9, 0.5)]
    cloud = np.concatenate([box, make_field()])
    T = pose(about_axis(UP, 2.0), np.array([30.0, -12.0, 1.5]))
    here, there = build(box, cloud), build(transform(T, box), transform(T, cloud))
    np.testing.assert_allclose(there.points, here.points, atol=1e-6)
    np.testing.assert_allclose(there.T_map_plan, T @ here.T_map_plan, atol=1e-6)
