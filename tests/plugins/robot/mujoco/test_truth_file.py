"""The truth that one process leaves is what an equal robot of another process knows."""

import numpy as np
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.errors import DataError
from executive.machine.machine import load_machine
from executive.messages.command import MoveJaws

ZERO_S = 0.5


def started(stones=2, seed=3):
    settings = MujocoSettings.model_validate(
        {"scenario": "kind", "site": {"stones": {"count": stones}}}
    )
    robot = MujocoRobot(settings, load_machine("m545"), np.random.default_rng(seed))
    robot.start()
    return robot


@pytest.fixture(scope="module")
def lived():
    robot = started()
    robot.command(MoveJaws(0.1, 5e3))
    robot.read(2.0)
    return robot


def test_poses_contacts_and_rests_are_read_back(lived, tmp_path):
    lived.write_truth(tmp_path / "truth.npz")
    other = started()
    other.read_truth(tmp_path / "truth.npz", ZERO_S)
    log, found = lived.truth_log, other.truth_log
    mine, theirs = lived.limit_log.found(), other.limit_log.found()
    assert max(one.largest_share for one in mine) > 0
    assert [one.largest_share for one in theirs] == [one.largest_share for one in mine]
    assert found.end_s == pytest.approx(log.end_s - ZERO_S)
    for at_s in (0.0, 0.73, 1.4):
        np.testing.assert_array_equal(found.centroids(at_s), log.centroids(at_s + ZERO_S))
        np.testing.assert_allclose(
            found.T_world_cabin(at_s), log.T_world_cabin(at_s + ZERO_S), atol=1e-12
        )
    assert len(found.spans()) == len(log.spans())
    for one, other_span in zip(log.spans(), found.spans(), strict=True):
        assert (other_span.link, other_span.other) == (one.link, one.other)
        assert other_span.from_s == pytest.approx(one.from_s - ZERO_S)
    for one, kept in zip(log.keep(), found.keep(), strict=True):
        np.testing.assert_allclose(kept[0], one[0] - ZERO_S)
        np.testing.assert_array_equal(kept[1], one[1])


def test_the_truth_of_another_site_is_refused(lived, tmp_path):
    lived.write_truth(tmp_path / "truth.npz")
    with pytest.raises(DataError, match="of another site"):
        started(stones=1).read_truth(tmp_path / "truth.npz", 0.0)


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_a_file_that_is_cut_off_is_refused(lived, tmp_path, share):
    path = tmp_path / "truth.npz"
    lived.write_truth(path)
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.raises(DataError, match=r"truth\.npz: the truth of the run cannot be read"):
        started().read_truth(path, 0.0)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        started().read_truth(tmp_path / "nothing.npz", 0.0)


def test_a_copy_of_the_site_is_surveyed_as_the_site_itself(lived):
    origins = np.tile([4.0, 0.0, 8.0], (400, 1))
    rays = np.random.default_rng(1).normal([0.0, 0.0, -3.0], 1.0, (400, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    site = lived.site_now()
    lived.cast_rays(origins, rays)  # a stone counts as at rest from the second look on
    np.testing.assert_allclose(
        site.cast_rays(origins, rays), lived.cast_rays(origins, rays), atol=2e-3
    )
