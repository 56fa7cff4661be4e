"""Stones and places are matched by what the machine may lift."""

import numpy as np
import pytest
from executive_plugins.placing.liftable_places import assigned, masses_kg, rated_kg

from executive.geometry.pose import pose
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine
from executive.messages.stone import STONE_DENSITY_KG_M3


def test_each_stone_takes_the_first_place_where_it_may_be_lifted() -> None:
    rated = np.array([1500.0, 2000.0, 3000.0, 2500.0])
    assert assigned(rated, [2400.0, 1400.0, 1900.0], 3) == [2, 0, 1]


def test_a_stone_that_may_be_lifted_nowhere_gets_the_strongest_place_that_is_left() -> None:
    assert assigned(np.array([1000.0, 1800.0, 1400.0]), [2000.0, 1900.0], 2) == [1, 2]


@pytest.mark.parametrize(("count", "expected"), [(0, []), (2, [1, 0]), (5, [1, 0, 2])])
def test_no_more_places_are_taken_than_asked_for_or_than_there_are(
    count: int, expected: list[int]
) -> None:
    assert assigned(np.array([900.0, 1200.0, 800.0]), [1100.0], count) == expected


def test_places_are_rated_where_the_machine_stands(machine: Machine) -> None:
    T_map_base = pose(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([20.0, 5.0, 1.0]))
    capacity = LiftCapacity(machine)
    beside, before, far = (13.75, 5.0, 0.0), (20.0, 9.25, 0.0), (20.0, 30.0, 0.0)
    rated = rated_kg(machine, np.array([beside, before, far]), T_map_base)
    sideways, forwards = capacity.near(6.25, np.pi / 2), capacity.near(4.25, 0.0)
    assert sideways is not None
    assert forwards is not None
    np.testing.assert_allclose(rated, [sideways.rated_kg, forwards.rated_kg, 0.0])


def test_masses_are_those_of_the_volumes_the_heaviest_first(site: tuple) -> None:
    block, ground, segmented, _ = site
    small, large = block((4.0, 0.0), half_m=0.3), block((6.0, 0.0), half_m=0.5)
    found = masses_kg(segmented(ground(), small, large))
    volumes_m3 = np.array([1.0 * 1.0 * 0.6, 0.6 * 0.6 * 0.6])
    np.testing.assert_allclose(found, volumes_m3 * STONE_DENSITY_KG_M3, rtol=1e-6)
