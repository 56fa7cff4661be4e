"""A path removes the distortion that its own motion causes."""

import numpy as np
from executive_plugins.odometry.sensor_path import SensorPath

from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3


def way(t: float) -> np.ndarray:
    """A screw: even turn about a tilted axis, even travel."""
    return pose(exp_so3(t * np.array([0.1, -0.2, 0.9])), t * np.array([1.0, 0.5, -0.2]))


def test_undistorted_points_coincide() -> None:
    rng = np.random.default_rng(0)
    world = rng.uniform(-10, 10, (200, 3))
    stamps = np.sort(rng.uniform(0, 0.1, 200))
    seen = np.array([transform(inverse(way(t)), p) for t, p in zip(stamps, world, strict=True)])
    path = SensorPath.of(
        np.linspace(0, 0.1, 11), np.array([way(t) for t in np.linspace(0, 0.1, 11)])
    )
    undistorted = path.undistort(seen, stamps)
    # 10 ms apart, poses in between are off by less than ω² dt² / 8 of a point's 17 m: 0.2 mm.
    np.testing.assert_allclose(undistorted, transform(inverse(way(0.1)), world), atol=5e-4)
    assert np.abs(seen - undistorted).max() > 0.5


def test_poses_at_samples_are_exact_and_constant_beyond_the_ends() -> None:
    stamps = np.linspace(0, 0.1, 11)
    path = SensorPath.of(stamps, np.array([way(t) for t in stamps]))
    np.testing.assert_allclose(path.T_end_then(0.03), inverse(way(0.1)) @ way(0.03), atol=1e-12)
    np.testing.assert_allclose(path.T_end_then(0.5), np.eye(4), atol=1e-12)
    np.testing.assert_allclose(path.T_end_then(-1.0), inverse(way(0.1)) @ way(0.0), atol=1e-12)
