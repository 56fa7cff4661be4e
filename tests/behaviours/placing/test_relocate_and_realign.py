"""RelocateAndRealign and ForgetPlace, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.find_again import FindAgain
from executive.behaviours.forget_place import ForgetPlace
from executive.behaviours.relocate_and_realign import RelocateAndRealign
from executive.errors import DataError
from executive.events.stone import PlaceForgotten, StoneRealigned
from executive.geometry.pose import pose, transform
from executive.interfaces.alignment import Aligner
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.messages.stone import StoneState
from tests.behaviours.placing.scene import alignment, plugins


@pytest.mark.parametrize(
    ("aligned", "found", "method", "moved_m"),
    [
        (alignment(True), None, "alignment", 0.1),
        (alignment(False), alignment(True, 0.7), "registration", 0.7),
        (alignment(True, 0.6), alignment(True, 0.7), "registration", 0.7),
        (alignment(False), alignment(False), "alignment", 0.0),
    ],
    ids=["aligned", "registered", "shifted too far", "refused"],
)
def test_a_relocated_stone_is_realigned_or_its_pose_kept(
    stage, world, database, aligned, found, method, moved_m
):
    database.release(1, world.hold.T_map_gripper, 3.0, StoneState.PLACED)
    aligner, registrar = (
        stage.Scripted(Aligner, align=aligned),
        stage.Scripted(Registrar, find=found),
    )
    plugins(world).update(alignment=aligner, registration=registrar)
    shown = pose(t=np.array([moved_m, 0.0, 0.0]))
    plugins(world)["mapping"].add_surface(transform(shown, database.stone(1).points_map))
    ended = world.tick(RelocateAndRealign, stone=1)
    assert ended.status == ("SUCCESS" if moved_m else "FAILURE")
    (event,) = ended.events
    assert isinstance(event, StoneRealigned)
    assert (event.accepted, event.method) == (moved_m > 0, method)
    assert (event.reason == "") == (moved_m > 0)
    assert database.stone(1).T_map_object[0, 3] == pytest.approx(5.0 + moved_m, abs=0.05)
    assert len(registrar.calls("find")) == (found is not None)
    np.testing.assert_array_equal(
        aligner.calls("align")[0]["source"].points[:, 1:].mean(axis=0).round(1), [0.0, 0.3]
    )


def test_the_map_forgets_a_place_and_keeps_the_neighbours(world, database):
    before = plugins(world)["mapping"].cloud().points
    ended = world.tick(ForgetPlace, stone=2)
    assert ended.status == "SUCCESS"
    after = plugins(world)["mapping"].cloud().points
    (event,) = ended.events
    assert isinstance(event, PlaceForgotten)
    assert event.stone == 2
    assert event.removed_points == len(before) - len(after) + event.put_back_points > 100
    assert np.linalg.norm(after - database.stone(2).centroid_map, axis=1).min() > 0.9


@pytest.mark.parametrize("leaf", [ForgetPlace, FindAgain, RelocateAndRealign])
def test_a_stone_that_nobody_knows_is_an_error(stage, world, leaf):
    unused = {"alignment": Aligner, "registration": Registrar, "segmentation": Segmenter}
    plugins(world).update({name: stage.Scripted(kind) for name, kind in unused.items()})
    with pytest.raises(DataError, match="9"):
        world.tick(leaf, stone=9)
