"""Stones and places are matched by what the machine may lift."""

import numpy as np
import pytest
from executive_plugins.placing.liftable_places import (
    Load,
    assigned,
    loads,
    rated_kg,
    swings_rad,
)

from executive.geometry.pose import pose
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine
from executive.messages.stone import STONE_DENSITY_KG_M3


def test_each_stone_gets_a_place_where_it_may_be_lifted_with_the_least_swings() -> None:
    rated = np.array([1500.0, 2000.0, 3000.0, 2500.0])
    swings = np.array([[0.1, 0.1, 2.0, 1.0], [0.5, 0.2, 0.1, 0.1], [0.1, 0.4, 0.1, 0.1]])
    assert assigned(rated, [2400.0, 1900.0, 1400.0], swings, 3) == [(3, 0), (2, 1), (0, 2)]


def test_a_stone_keeps_no_heavier_one_from_the_only_place_where_that_may_be_lifted() -> None:
    swings = np.array([[2.0, 0.0], [0.0, 2.0]])
    found = assigned(np.array([3000.0, 2000.0]), [2400.0, 1900.0], swings, 2)
    assert found == [(0, 0), (1, 1)]


def test_a_stone_that_may_be_lifted_nowhere_gets_a_place_that_lacks_little() -> None:
    swings = np.array([[0.0, 1.0, 0.5]])
    found = assigned(np.array([1000.0, 1800.0, 1400.0]), [2000.0], swings, 2)
    assert found == [(1, 0), (0, None)]


def test_of_too_few_places_each_says_which_stone_it_is_for() -> None:
    """The heaviest stone may be lifted to none of them."""
    rated = np.array([1500.0, 1000.0])
    found = assigned(rated, [2000.0, 1400.0, 900.0], np.zeros((3, 2)), 3)
    assert sorted(found) == [(0, 1), (1, 2)]


@pytest.mark.parametrize(("count", "expected"), [(0, []), (2, [1, 0]), (5, [1, 0, 2])])
def test_no_more_places_are_taken_than_asked_for_or_than_there_are(
    count: int, expected: list[int]
) -> None:
    rated = np.array([900.0, 1200.0, 800.0])
    found = assigned(rated, [1100.0], np.zeros((1, 3)), count)
    assert [place for place, _ in found] == expected


def test_places_are_rated_where_the_machine_stands(machine: Machine) -> None:
    T_map_base = pose(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([20.0, 5.0, 1.0]))
    capacity = LiftCapacity(machine)
    beside, before, far = (13.75, 5.0, 0.0), (20.0, 9.25, 0.0), (20.0, 30.0, 0.0)
    rated = rated_kg(machine, np.array([beside, before, far]), T_map_base)
    sideways, forwards = capacity.near(6.25, np.pi / 2), capacity.near(4.25, 0.0)
    assert sideways is not None
    assert forwards is not None
    np.testing.assert_allclose(rated, [sideways.rated_kg, forwards.rated_kg, 0.0])


def test_loads_have_the_masses_of_the_volumes_the_heaviest_first(site: tuple) -> None:
    block, ground, segmented, _ = site
    small, large = block((4.0, 0.0), half_m=0.3), block((6.0, 0.0), half_m=0.5)
    found = loads(segmented(ground(), small, large))
    for load, points in zip(found, (large, small), strict=True):
        np.testing.assert_allclose(load.position_map, points.mean(axis=0))
    volumes_m3 = np.array([1.0 * 1.0 * 0.6, 0.6 * 0.6 * 0.6])
    masses = [one.mass_kg for one in found]
    np.testing.assert_allclose(masses, volumes_m3 * STONE_DENSITY_KG_M3, rtol=1e-6)


def test_a_swing_is_the_turn_of_the_cabin_the_shorter_way_round() -> None:
    T_map_base = pose(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([20.0, 5.0, 1.0]))
    stones = [Load(1000.0, np.array([21.0, 9.0, 0.0]))]
    places_map = np.array([[20.0, 9.0, 0.0], [20.0, 1.0, 0.0]])
    side = np.arctan2(1.0, 4.0)
    found = swings_rad(stones, places_map, T_map_base)
    np.testing.assert_allclose(found, [[side, np.pi - side]], atol=1e-9)
    assert swings_rad([], places_map, T_map_base).shape == (0, 2)
