"""A stone must stay where it rests when the shapes of all stones are modelled otherwise."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.other_shapes import OtherShapes
from executive_plugins.placing.dry_stone.parts import Place, Stability
from executive_plugins.placing.dry_stone.settings import CheckSettings
from executive_plugins.placing.dry_stone.stability import Checks, Equilibrium, Settling

from executive.geometry.pose import pose
from executive.messages.building import StandingStone
from executive.messages.solid_stone import SolidStone
from executive.testing.exercises.building import bare, box

# The convex hull fills the notch of the stone below; a second model of 30 pieces leaves it open.
SETTINGS = {"pieces": 1, "samples": 2, "noise": 0.005, "tilt_noise": 0.005}
TOP_M, NOTCH_M, DEPTH_M = 0.6, 0.5, 0.2
STONE = box("next", 0.5, 0.5, 0.3)


def notched():
    """Return a stone of 2 × 0.8 × 0.6 m that lies on the ground, a notch across its top at x = 0.5.

    The notch is as wide as 0.8 m at the top, and 0.2 m deep: the stone of 0.5 m falls 7.5 cm into
    it.
    """
    x, y = np.linspace(-1.0, 1.0, 21), np.linspace(-0.4, 0.4, 9)
    X, Y = (grid.ravel() for grid in np.meshgrid(x, y, indexing="ij"))
    depth = DEPTH_M * np.clip(1.0 - np.abs(X - NOTCH_M) / 0.4, 0.0, None)
    bottom, top = np.zeros(len(X)), np.full(len(X), TOP_M)
    vertices = np.vstack([np.column_stack([X, Y, bottom]), np.column_stack([X, Y, top - depth])])
    triangles = closed(len(x), len(y))
    stone = SolidStone.of_mesh("notched", vertices, triangles, 2600.0)
    at = vertices[0] - stone.vertices[0]
    return bare().with_standing(StandingStone(stone, pose(t=at)))


def closed(nx: int, ny: int):
    """Return the triangles of two sheets of nodes, one above the other, and of their sides."""
    node = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]
    up = np.vstack([np.stack(one, axis=-1).reshape(-1, 3) for one in ((a, b, c), (a, c, d))])
    rim = np.concatenate([node[:-1, 0], node[-1, :-1], node[:0:-1, -1], node[0, :0:-1]])
    after, above = np.roll(rim, -1), nx * ny
    sides = [(rim, after, after + above), (rim, after + above, rim + above)]
    return np.vstack([up[:, ::-1], up + above, *(np.stack(s, axis=-1) for s in sides)])


def found_at(x: float, part: type[Checks] = Checks, **settings: object) -> Stability:
    place = Place(STONE, pose(t=np.array([x, 0.0, TOP_M + 0.16])), 0.0, {})
    check = part(CheckSettings.model_validate({**SETTINGS, **settings}))
    return check.check(place, notched(), np.random.default_rng(3), lambda: True)


@pytest.mark.parametrize("part", [Checks, Settling])
def test_a_stone_that_bears_on_a_hollow_of_the_other_model_is_refused(part: type[Checks]) -> None:
    assert found_at(NOTCH_M, part).refusal == "reseats"


def test_the_same_place_holds_without_a_second_model() -> None:
    found = found_at(NOTCH_M, other_pieces=0)
    assert (found.refusal, found.terms["reseats_m"]) == ("", 0.0)
    assert found.T_map_settled[2, 3] == pytest.approx(TOP_M + 0.15, abs=0.01)


def test_a_balance_of_forces_alone_asks_for_no_second_model() -> None:
    assert found_at(NOTCH_M, Equilibrium).refusal == ""


def test_a_stone_on_a_face_that_all_models_have_holds_and_says_how_it_moved() -> None:
    found = found_at(-0.5)
    assert found.refusal == ""
    assert 0.0 <= found.terms["reseats_m"] < 0.005


def test_a_stone_that_noise_can_take_into_the_hollow_is_refused_for_it() -> None:
    """At its place most of the stone is beside the notch; the releases go some way to each side."""
    found = found_at(0.08, samples=16, noise=0.05, worst=0.3, worst_tilt=0.5)
    assert found.refusal == "reseats_under_noise"


def test_what_may_move_is_a_setting() -> None:
    assert found_at(NOTCH_M, reseated=0.3).refusal == ""


def test_a_stone_with_nothing_below_is_told_from_one_that_stays() -> None:
    built, settings = notched(), CheckSettings()
    shapes = OtherShapes(built, [built.standing[0].T_map_stone], STONE, settings)
    assert shapes.moves(pose(t=np.array([0.5, 0.0, TOP_M + 0.15]))) > settings.reseated
    assert shapes.moves(pose(t=np.array([-0.5, 0.0, TOP_M + 0.15]))) < 0.005


def test_stones_that_are_all_convex_have_one_shape_and_stay() -> None:
    base = StandingStone(box("base", 2.0, 0.8, TOP_M), pose(t=np.array([0.0, 0.0, TOP_M / 2])))
    built, there = bare().with_standing(base), pose(t=np.array([0.0, 0.0, TOP_M + 0.15]))
    convex = OtherShapes(built, [base.T_map_stone], STONE, CheckSettings())
    in_the_air = pose(t=np.array([0.0, 0.0, 3.0]))
    assert (convex.moves(there), convex.moves(in_the_air)) == (0.0, 0.0)  # nothing is tried
