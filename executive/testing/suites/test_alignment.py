"""What every aligner must do, whatever its method."""

import numpy as np
import pytest

from executive.errors import DataError
from executive.geometry.pose import transform
from executive.interfaces.alignment import Aligner
from executive.messages.cloud import Cloud
from executive.testing.exercises.alignment import T_TRUE, clouds
from executive.testing.pytest_plugin import Insist

CAPABILITY = "alignment"


def test_a_small_motion_is_recovered_and_accepted(plugin: Aligner, insist: Insist) -> None:
    target, source = clouds()
    found = plugin.align(target, source, np.eye(4), 0.3)
    insist(found.accepted, found.reason)
    assert found.scale == 1.0
    assert (
        np.linalg.norm(found.apply(source.points) - transform(T_TRUE, source.points), axis=1).max()
        < 0.02
    )
    assert 0.5 < found.overlap <= 1.0
    assert 0.0 < found.rmse_m < 0.05


def test_the_result_is_a_rigid_pose(plugin: Aligner) -> None:
    T = plugin.align(*clouds(), np.eye(4), 0.3).T_target_source
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-9)
    assert np.linalg.det(T[:3, :3]) > 0
    np.testing.assert_array_equal(T[3], [0, 0, 0, 1])


def test_a_refusal_has_a_reason(plugin: Aligner) -> None:
    target, source = clouds()
    for other in (Cloud("map", target.points + 100.0), Cloud("map", np.empty((0, 3)))):
        found = plugin.align(other, source, np.eye(4), 0.3)
        assert not found.accepted
        assert found.reason


def test_a_reach_that_is_not_positive_is_an_error(plugin: Aligner) -> None:
    with pytest.raises(DataError):
        plugin.align(*clouds(), np.eye(4), -1.0)
