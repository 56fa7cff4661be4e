"""What every aligner must do, whatever its method."""

from collections.abc import Iterator

import numpy as np
import pytest

from executive import registry
from executive.errors import DataError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.interfaces.alignment import Aligner
from executive.messages.cloud import Cloud

T_TRUE = pose(exp_so3(np.array([0.02, -0.03, 0.08])), np.array([0.08, -0.05, 0.04]))


@pytest.fixture(params=[plugin.name for plugin in registry.installed("alignment")])
def aligner(request: pytest.FixtureRequest) -> Iterator[Aligner]:
    plugin = registry.load("alignment", request.param)
    services = {"rng": np.random.default_rng(0)}
    aligner = plugin(
        plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin))
    )
    aligner.start()
    yield aligner
    aligner.close()


def corner(seed: int) -> np.ndarray:
    """Three faces of a block on the ground, freshly sampled by each seed."""
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-0.5, 0.5, (2, 12_000))
    faces = [
        np.column_stack([u, v, np.full(12_000, 0.4)]),
        np.column_stack([np.full(12_000, 0.5), u, 0.8 * v]),
    ]
    faces += [
        np.column_stack([u, np.full(12_000, -0.5), 0.8 * v]),
        np.column_stack([3 * u, 3 * v, np.full(12_000, -0.4)]),
    ]
    return np.vstack(faces) + rng.normal(0, 0.006, (48_000, 3))


def clouds() -> tuple[Cloud, Cloud]:
    return Cloud("map", corner(1)), Cloud("model", transform(inverse(T_TRUE), corner(2)))


def test_it_is_an_aligner(aligner: Aligner) -> None:
    assert isinstance(aligner, Aligner)


def test_a_small_motion_is_recovered_and_accepted(aligner: Aligner) -> None:
    target, source = clouds()
    found = aligner.align(target, source, np.eye(4), 0.3)
    assert found.accepted, found.reason
    assert found.scale == 1.0
    assert (
        np.linalg.norm(found.apply(source.points) - transform(T_TRUE, source.points), axis=1).max()
        < 0.02
    )
    assert 0.5 < found.overlap <= 1.0
    assert 0.0 < found.rmse_m < 0.05


def test_the_result_is_a_rigid_pose(aligner: Aligner) -> None:
    T = aligner.align(*clouds(), np.eye(4), 0.3).T_target_source
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-9)
    assert np.linalg.det(T[:3, :3]) > 0
    np.testing.assert_array_equal(T[3], [0, 0, 0, 1])


def test_the_same_clouds_give_the_same_bits_and_stay_as_they_were(aligner: Aligner) -> None:
    target, source = clouds()
    before = target.points.copy(), source.points.copy()
    first, second = (aligner.align(target, source, np.eye(4), 0.3) for _ in range(2))
    np.testing.assert_array_equal(first.T_target_source, second.T_target_source)
    assert (first.rmse_m, first.overlap, first.reason) == (
        second.rmse_m,
        second.overlap,
        second.reason,
    )
    np.testing.assert_array_equal(target.points, before[0])
    np.testing.assert_array_equal(source.points, before[1])


def test_a_refusal_has_a_reason(aligner: Aligner) -> None:
    target, source = clouds()
    for other in (Cloud("map", target.points + 100.0), Cloud("map", np.empty((0, 3)))):
        found = aligner.align(other, source, np.eye(4), 0.3)
        assert not found.accepted
        assert found.reason


def test_a_reach_that_is_not_positive_is_an_error(aligner: Aligner) -> None:
    with pytest.raises(DataError):
        aligner.align(*clouds(), np.eye(4), -1.0)
