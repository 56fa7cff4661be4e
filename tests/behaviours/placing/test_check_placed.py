"""CheckPlaced, ticked to success and to failure."""

from dataclasses import replace

import numpy as np
import pytest

from executive.behaviours.check_placed import CheckPlaced
from executive.behaviours.release_stone import ReleaseStone
from executive.events.stone import StoneLost
from executive.geometry.pose import pose, transform
from executive.interfaces.alignment import Aligner
from executive.interfaces.mapping import Mapper
from executive.interfaces.registration import Registrar
from executive.messages.cloud import Cloud
from executive.messages.stone import StoneState
from tests.behaviours.placing.scene import DROP, SLIP, alignment, plugins, set_down


def test_a_placed_stone_that_is_seen_elsewhere_or_nowhere_is_lost(stage, world, database):
    set_down(world, database, realigned=pose())
    registrar = stage.Scripted(Registrar, find=alignment(False))
    for aligned, status, words in [
        (alignment(True, 0.1), "SUCCESS", "1 stones are seen"),
        (alignment(True, 0.4), "FAILURE", "stone 1 is 0.40 m off its place"),
    ]:
        aligner = stage.Scripted(Aligner, align=aligned)
        plugins(world).update(alignment=aligner, registration=registrar)
        place = database.stone(1)
        plugins(world)["mapping"].remove_sphere(place.centroid_map, 2 * place.reach_m)
        plugins(world)["mapping"].add_surface(aligned.apply(place.points_map))
        ended = world.tick(CheckPlaced)
        assert (ended.status, words in ended.reason) == (status, True)
    assert database.stone(1).state is StoneState.LOST
    database.set_state(1, StoneState.PLACED, 8.0)
    plugins(world)["alignment"] = stage.Scripted(Aligner, align=alignment(False))
    ended = world.tick(CheckPlaced)
    assert (ended.status, "is not seen at its place" in ended.reason) == ("FAILURE", True)


def test_a_placed_stone_of_which_a_sparse_map_shows_a_little_is_in_doubt_and_not_lost(
    stage, world, database
):
    set_down(world, database, realigned=pose())
    own = database.stone(1).points_map
    few = own[own[:, 2] > np.median(own[:, 2])][::8]
    refused = alignment(False)
    plugins(world).update(
        mapping=stage.PointMap(np.vstack([few, own[own[:, 2] < own[:, 2].min() + 0.1]])),
        alignment=stage.Scripted(Aligner, align=refused),
        registration=stage.Scripted(Registrar, find=refused),
    )
    ended = world.tick(CheckPlaced)
    assert (ended.status, ended.reason) == (
        "SUCCESS",
        "0 stones are seen at their places, 1 are neither confirmed nor refuted",
    )
    assert database.stone(1).state is StoneState.PLACED


@pytest.mark.parametrize(("is_aligned", "status"), [(True, "SUCCESS"), (False, "FAILURE")])
def test_a_placed_stone_that_a_later_one_has_pushed_down_is_asked_for_where_it_is(
    stage, world, database, is_aligned, status
):
    """The sparse map shows its form 4 cm away, which only the alignment knows."""
    set_down(world, database, realigned=pose())
    own = database.stone(1).points_map
    moved = pose(t=np.array([0.0, 0.0, -0.04]))
    few = own[own[:, 2] > np.median(own[:, 2])][::8]
    plugins(world).update(
        mapping=stage.PointMap(
            np.vstack([transform(moved, few), own[own[:, 2] < own[:, 2].min() + 0.1]])
        ),
        alignment=stage.Scripted(
            Aligner, align=replace(alignment(is_aligned), T_target_source=moved)
        ),
        registration=stage.Scripted(Registrar, find=alignment(False)),
    )
    assert world.tick(CheckPlaced).status == status


def test_a_placed_stone_beyond_the_map_is_not_lost(stage, world, database):
    set_down(world, database, realigned=pose())
    far = Cloud("map", np.array([[40.0, 0.0, 0.0]]))
    plugins(world).update(mapping=stage.Scripted(Mapper, cloud=far))
    ended = world.tick(CheckPlaced)
    assert (ended.status, ended.reason) == (
        "SUCCESS",
        "0 stones are seen at their places, 1 are beyond the map",
    )
    assert database.stone(1).state is StoneState.PLACED


@pytest.mark.parametrize(("rim_m", "status"), [(-0.3, "SUCCESS"), (0.35, "FAILURE")])
def test_a_placed_stone_at_the_rim_of_the_map_is_lost_only_where_its_place_is_shown(
    stage, world, database, rim_m, status
):
    """The stone is gone, and the map ends short of its middle, or shows most of its place."""
    set_down(world, database, realigned=pose())
    x = database.stone(1).centroid_map[0]
    grid = np.stack(np.meshgrid(np.arange(0, 9, 0.1), np.arange(-9, 5, 0.1)), -1).reshape(-1, 2)
    shown = grid[grid[:, 0] < x + rim_m]
    ground = Cloud("map", np.column_stack([shown, np.zeros(len(shown))]))
    refused = alignment(False)
    plugins(world).update(
        mapping=stage.Scripted(Mapper, cloud=ground),
        alignment=stage.Scripted(Aligner, align=refused),
        registration=stage.Scripted(Registrar, find=refused),
    )
    ended = world.tick(CheckPlaced)
    assert ended.status == status, ended.reason
    lost = database.stone(1).state is StoneState.LOST
    assert lost == (status == "FAILURE")


def test_a_stone_that_fell_is_lost_and_one_that_slipped_is_not(world, database):
    world.leaf_context.troubles = [SLIP]
    world.tick(ReleaseStone, hold=world.hold)
    assert database.stone(1).state is StoneState.ON_GROUND
    database.grasp(1, world.hold.T_map_gripper, 6.0)
    world.leaf_context.troubles = [SLIP, DROP]
    ended = world.tick(ReleaseStone, hold=world.hold)
    assert database.stone(1).state is StoneState.LOST
    (event,) = (one for one in ended.events if isinstance(one, StoneLost))
    assert (event.stone, event.reason) == (1, "it fell: 12 kg left of 900 kg")
