"""The solid of a known stone: the hull of what was seen, down to the ground, and room around it."""

import itertools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.leaf.solid_stones import solid_stone, solid_stones
from executive.messages.stone import Stone, StoneState

LENGTH_M, WIDTH_M, HEIGHT_M = 1.0, 0.6, 0.5  # of what is seen of the block
STEPS = 11


def block(low_m):
    """Return points on the surface of a block whose lowest seen part is so high [m]."""
    unit = np.array(list(itertools.product(np.linspace(0.0, 1.0, STEPS), repeat=3)))
    on_surface = ((unit == 0.0) | (unit == 1.0)).any(axis=1)
    size = (LENGTH_M, WIDTH_M, HEIGHT_M)
    return unit[on_surface] * size + (5.0, 2.0, low_m)


def ground(z_m=0.0):
    steps = np.linspace(-2.0, 2.0, 41)
    x, y = np.meshgrid(5.0 + steps, 2.0 + steps)
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, z_m)])


NO_GROUND = np.zeros((0, 3))


class Objects:
    """A database that knows how each stone lay."""

    def __init__(self, *history):
        self.kept = [SimpleNamespace(kind=kind, T_map_object=T) for kind, T in history]

    def history(self, stone_id):
        return self.kept


def stone(points, T=None, number=1):
    T = pose(t=points.mean(axis=0)) if T is None else T
    return Stone(number, StoneState.ON_GROUND, points, points.mean(axis=0), T, False)


def size_of(standing):
    return np.ptp(standing.stone.vertices, axis=0)


def test_a_stone_that_was_seen_to_the_ground_is_the_hull_of_its_points():
    standing = solid_stone(stone(block(0.0)), ground(), Objects())
    assert size_of(standing) == pytest.approx([LENGTH_M, WIDTH_M, HEIGHT_M], abs=0.04)
    assert standing.stone.volume_m3 == pytest.approx(LENGTH_M * WIDTH_M * HEIGHT_M, rel=0.1)
    assert standing.stone.name == "1"
    assert standing.stone.doubt_m == 0.0


@pytest.mark.parametrize(
    ("low_m", "foot_m"), [(0.1, 0.1), (0.34, 0.34), (0.36, 0.0), (0.0, 0.0), (-0.1, 0.0)]
)
def test_its_foot_goes_down_to_the_ground_unless_that_is_too_far_below(low_m, foot_m):
    standing = solid_stone(stone(block(low_m)), ground(), Objects())
    assert size_of(standing)[2] == pytest.approx(HEIGHT_M + foot_m, abs=0.01)


@pytest.mark.parametrize(
    ("kinds", "foot_m"),
    [
        (("found", "grasp", "reshaped"), 0.0),
        (("found", "reshaped", "seen", "realign"), 0.0),
        (("found", "reshaped", "replaced"), 0.1),  # the model is another one since
        (("found", "seen"), 0.1),
    ],
)
def test_a_foot_that_was_seen_from_below_is_not_guessed(kinds, foot_m):
    lying = stone(block(0.1))
    objects = Objects(*((kind, lying.T_map_object) for kind in kinds))
    standing = solid_stone(lying, ground(), objects)
    assert size_of(standing)[2] == pytest.approx(HEIGHT_M + foot_m, abs=0.01)


def test_what_was_seen_of_an_underside_may_lie_in_a_hollow_of_the_ground():
    points = block(-0.06)
    objects = Objects(("found", stone(points).T_map_object), ("reshaped", None))
    hanging = replace(stone(points), state=StoneState.HELD)
    vertices = solid_stone(hanging, ground(), objects).vertices_map()
    assert vertices[:, 2].min() == pytest.approx(-0.06, abs=0.01)


def test_without_ground_around_it_no_foot_is_added():
    for around in (NO_GROUND, ground() + (50.0, 0.0, 0.0)):
        standing = solid_stone(stone(block(0.1)), around, Objects())
        assert size_of(standing)[2] == pytest.approx(HEIGHT_M, abs=0.01)


def test_room_is_added_on_each_side_and_not_above():
    plain = solid_stone(stone(block(0.0)), ground(), Objects())
    roomy = solid_stone(stone(block(0.0)), ground(), Objects(), room_m=0.1)
    assert size_of(roomy)[:2] == pytest.approx(size_of(plain)[:2] + 0.2, abs=0.01)
    assert size_of(roomy)[2] == pytest.approx(size_of(plain)[2], abs=1e-9)
    assert roomy.stone.doubt_m == 0.1


def test_it_stands_where_the_centre_of_its_volume_is_with_the_axes_of_the_map():
    standing = solid_stone(stone(block(0.0)), ground(), Objects())
    T = standing.T_map_stone
    assert T[:3, :3] == pytest.approx(np.eye(3))
    centre = (5.0 + LENGTH_M / 2, 2.0 + WIDTH_M / 2, HEIGHT_M / 2)
    assert T[:3, 3] == pytest.approx(centre, abs=0.04)


def test_a_stone_that_was_turned_keeps_the_foot_on_which_it_lay():
    lay = pose(t=(5.5, 2.3, 0.35))
    now = pose(from_rpy(np.pi / 2, 0.0, 0.0), (9.0, 1.0, 0.5))
    points = (block(0.1) - lay[:3, 3]) @ now[:3, :3].T + now[:3, 3]
    objects = Objects(("seen", lay), ("grasp", now), ("seen", now))
    standing = solid_stone(stone(points, now), ground(), objects)
    sizes = [LENGTH_M, HEIGHT_M + 0.1, WIDTH_M]  # the foot is at its side now
    assert size_of(standing) == pytest.approx(sizes, abs=0.04)


def leaning(low_m, state=StoneState.ON_GROUND):
    """Return a block that was seen all around and lies turned by 20° since it was grasped."""
    lay = pose(t=(5.5, 2.3, 0.25))
    now = pose(from_rpy(np.radians(20.0), 0.0, 0.0), (5.5, 2.3, 0.0))
    points = (block(0.0) - lay[:3, 3]) @ now[:3, :3].T + now[:3, 3]
    now[2, 3] = low_m - points[:, 2].min()
    points[:, 2] += now[2, 3]
    objects = Objects(("found", lay), ("grasp", now), ("release", now))
    return replace(stone(points, now), state=state), objects


def rests(standing):
    """Return whether its lowest 5 cm are around its centre of mass."""
    corners = standing.stone.vertices
    low = corners[corners[:, 2] < corners[:, 2].min() + 0.05, :2]
    return bool((low.min(axis=0) < 0.0).all() and (low.max(axis=0) > 0.0).all())


@pytest.mark.parametrize("low_m", [0.0, 0.1, -0.03])
def test_a_stone_that_lies_on_the_ground_in_another_attitude_is_carried_there(low_m):
    """It rests on what was not seen of it: otherwise it would not lie there."""
    one, objects = leaning(low_m)
    seen = np.ptp(one.points_map, axis=0)
    standing = solid_stone(one, ground(), objects)
    assert rests(standing)
    assert size_of(standing) == pytest.approx(seen + (0.0, 0.0, low_m), abs=0.04)


@pytest.mark.parametrize(
    ("state", "low_m", "around"),
    [
        (StoneState.HELD, 0.0, ground()),  # its foot has turned with it
        (StoneState.PLACED, 0.0, ground()),  # others may carry it
        (StoneState.ON_GROUND, 0.5, ground()),  # it lies on something else
        (StoneState.ON_GROUND, 0.0, NO_GROUND),
    ],
)
def test_what_is_not_known_to_lie_on_the_ground_is_carried_by_nothing_more(state, low_m, around):
    one, objects = leaning(low_m, state)
    standing = solid_stone(one, around, objects)
    assert not rests(standing)
    assert size_of(standing) == pytest.approx(np.ptp(one.points_map, axis=0), abs=0.04)


def test_each_stone_has_a_solid_by_its_number():
    found = solid_stones([stone(block(0.0), number=3), stone(block(0.0), number=7)], ground(),
                         Objects(), 0.05)  # fmt: skip
    assert {number: one.stone.name for number, one in found.items()} == {3: "3", 7: "7"}
    assert {one.stone.doubt_m for one in found.values()} == {0.05}
