"""Stones over many views: pushed, turned, grown, merged, lost, released and found again."""

import numpy as np
import pytest
from executive_plugins.objects.association import Reach, associate
from executive_plugins.objects.growth import fit_of, icp_shift, merged, shifts_of
from executive_plugins.objects.scene import surface_within, surroundings, unexplained
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects
from executive_plugins.objects.surface import box_centre, diagonal_m, pack, unpack

from executive.errors import DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState


def surface(seed: int = 0, count: int = 500, sizes=(0.5, 0.4, 0.3)) -> np.ndarray:
    d = np.random.default_rng(seed).normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1)[:, None] * sizes


def grid(seed: int, count: int = 60) -> np.ndarray:
    return np.random.default_rng(seed).integers(-8, 9, (count, 3)) / 8.0


def segment(points: np.ndarray, x: float = 0.0, y: float = 0.0) -> Segment:
    points = points + (x, y, 0.3)
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    return Segment(0, points, middle, np.ones(3))


def stone(number: int, points: np.ndarray, state=StoneState.ON_GROUND) -> Stone:
    return Stone(number, state, points, points.mean(axis=0), np.eye(4), False)


def test_association(recorded) -> None:
    box = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]])
    told = []
    for shift in (0.0, 0.5, 0.75, 0.875, 1.0):
        for scale in (0.5, 0.625, 1.0, 1.6, 2.0):
            seen = box * scale + (shift, 0, 0)
            one = Segment(0, seen, seen.mean(axis=0), np.ones(3))
            told.append(associate([one], [stone(1, box)], [Reach(0.875)], 1.6))
    many = [segment(grid(k), 1.5 * k) for k in range(4)]
    known = [stone(k, grid(k) + (1.5 * k + 0.25, 0, 0.3)) for k in (2, 0, 1)]
    told += [associate(many, known, [Reach(2.0)] * 3, 2.0), associate([], known, [], 1.0)]
    told.append(associate(many, [], [], 1.0))
    recorded(told)


def test_growth(recorded) -> None:
    model, told = surface(1), []
    views = model[model[:, 2] > 0] + 0.02, surface(2) * 1.2, surface(3) + 3.0, grid(4)
    for view in views:
        fit = fit_of(model, view, 0.1)
        told += [fit, str(fit), shifts_of(model, view, 0.1), icp_shift(model, view, 0.15)]
        told += [merged(model, view, 0.1, 9000), merged(model[:0], view, 0.1, 120)]
        told.append(len(merged(model, view, 0.05, 150)))
    flat = fit_of(np.zeros((2, 3)), grid(1), 0.125)
    recorded((told, flat, diagonal_m(grid(2)), box_centre(grid(3)), unpack(pack(grid(5)))))


def test_scenes(recorded) -> None:
    cloud = grid(6, 400) * 1.5
    stones = [
        stone(1, grid(7)),
        stone(2, grid(8) * 0.5 + (0.75, 0, 0), StoneState.HELD),
        stone(3, grid(9) * 0.5 - (0.5, 0.5, 0), StoneState.PLACED),
    ]
    told = [surroundings(cloud, stones, one, 0.125, 0.25) for one in (None, *stones)]
    told += [unexplained(cloud, stones[:n], 0.25, 0.125) for n in (0, 1, 3)]
    told.append(unexplained(cloud[:0], stones, 0.25, 0.125))
    told += [surface_within(stones, np.zeros(3), r) for r in (0.5, 0.625, 9.0)]
    recorded([np.sort(points, axis=0) for points in told])


SETTINGS = {"voxel_m": 0.06, "max_points": 400, "max_roll_m": 2.0}


def test_a_story(recorded) -> None:
    database = SqliteObjects(SqliteObjectsSettings(**SETTINGS))
    database.open(":memory:")
    told: list[object] = []
    half = surface()[surface()[:, 2] > -0.05]
    for stamp, (segments, above) in enumerate(
        [
            ([segment(half), segment(surface(5), 4.0)], False),
            ([segment(surface()), segment(surface(5), 4.1)], True),  # grown; pushed
            ([segment(surface(9)[:, [1, 2, 0]], 0.1), segment(surface(5), 4.1)], False),  # turned
            ([segment(np.vstack([surface(), surface() + (0.5, 0, 0)]))], False),  # two in one
            ([segment(surface(), 0.2), segment(surface(6) * 0.2, 0.9)], True),  # a pebble
            ([], False),
        ]
    ):
        told.append(database.observe(segments, float(stamp), above))
    grasp, release = (
        pose(None, np.array([4.0, 0, 1.0])),
        pose(from_rpy(0, 0, 1.0), np.array([0, 5.0, 1])),
    )
    told.append(database.grasp(2, grasp, 10.0))
    told.append(database.observe([segment(surface(5), 4.1)], 11.0, False))
    told.append(database.release(2, release, 12.0, StoneState.ON_GROUND))
    told.append(database.observe([segment(surface(5), 0.0, 6.5)], 13.0, False))  # rolled
    told.append(database.observe([segment(surface(5), 0.0, 7.9)], 14.0, False))  # too far
    told.append(database.set_state(1, StoneState.LOST, 15.0))
    told.append(database.observe([segment(surface(), 1.8)], 16.0, False))
    told.append(database.realign(1, pose(from_rpy(0.1, 0, 0), np.ones(3)), 17.0))
    cloud = Cloud("map", np.vstack([one.points_map for one in database.stones()]) + 0.01)
    told += [database.surroundings(cloud, 1), database.unexplained(cloud, 2, 1.5)]
    told += [database.surface_within(np.array([0.0, 6.0, 0.3]), 1.0, w) for w in (None, 2)]
    numbers = [one.id for one in database.stones()]
    recorded((told, numbers, [database.history(n) for n in numbers]), relative=1e-7)


@pytest.mark.parametrize("state", list(StoneState))
def test_refusals(recorded, state) -> None:
    database = SqliteObjects(SqliteObjectsSettings(**SETTINGS))
    database.open(":memory:")
    database.observe([segment(surface())], 0.0, False)
    told = []
    calls = (
        lambda: database.release(1, np.eye(4), 1.0, state),
        lambda: database.set_state(1, state, 2.0).state,
        lambda: database.grasp(1, np.eye(4), 3.0).state,
        lambda: database.grasp(1, np.eye(4), 4.0).state,
        lambda: database.release(1, np.eye(4), 5.0, state).state,
        lambda: database.stone(7),
        lambda: database.observe([segment(np.zeros((0, 3)))], 6.0, False),
    )
    for call in calls:
        try:
            told.append(call())
        except DataError as error:
            told.append(error)
    recorded(told)
