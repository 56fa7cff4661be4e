"""Jaws wait beside a stone until the arm has moved away from it."""

import numpy as np
import pytest
from executive_plugins.objects.sqlite import SqliteObjects

from executive.behaviours.wait_for_room import WaitForRoom, WaitForRoomSettings
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.interfaces.objects import ObjectDatabase


class Objects(SqliteObjects):
    """One stone of given points."""

    def __init__(self, points: np.ndarray) -> None:
        super().__init__(SqliteObjects.Settings())
        self.points = points

    def surface_within(self, centre_map, radius_m, without=None):
        is_near = np.linalg.norm(self.points - centre_map, axis=1) < radius_m
        return self.points[is_near]


@pytest.fixture
def beside(fakes):
    """Return a function that makes a leaf whose right jaw, once open, is in a stone."""

    def made(rises_m_s, **settings):
        context = fakes.Context(objects=Objects(np.zeros((0, 3))))
        gripper = context.machine().gripper
        T_map_gripper = pose(from_rpy(0, np.pi / 2, 0), np.array([4.0, 0.0, 2.0]))
        tip = transform(T_map_gripper, gripper.tips(gripper.open_rad))[0]
        context.plugins["objects"].points = tip + np.random.default_rng(0).uniform(
            -0.05, 0.05, (200, 3)
        )

        def here():
            T = T_map_gripper.copy()
            T[2, 3] += rises_m_s * context.now_s()
            return T

        context.gripper = here
        return context, WaitForRoom(WaitForRoomSettings(**settings), context)

    return made


def test_jaws_wait_until_the_arm_is_above_the_stone(beside, fakes):
    context, leaf = beside(0.5)
    outcome = fakes.finish(leaf)
    assert outcome.success
    assert outcome.reason == ""
    assert 0.1 < context.now_s() < 4.0


def test_without_a_stone_nothing_is_waited_for(beside, fakes):
    context, leaf = beside(0.0)
    context.use(ObjectDatabase).points = np.zeros((0, 3))
    before_s = context.now_s()
    assert fakes.finish(leaf).success
    assert context.now_s() == before_s


def test_an_arm_that_stays_is_told_and_waits_no_longer_than_it_may(beside, fakes):
    context, leaf = beside(0.0, most=1.0)
    outcome = fakes.finish(leaf)
    assert outcome.success
    assert outcome.reason.startswith("no room for open jaws after 1.0")
    assert context.now_s() < 1.5
