import numpy as np
from executive_plugins.motion.obstacles import Obstacles

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3


def test_the_compiled_loop_tells_what_the_maps_tell_point_by_point() -> None:
    rng = np.random.default_rng(3)
    xy = rng.uniform(-5, 5, (20000, 2))
    on_stone = np.hypot(*(xy - 2.0).T) < 0.7
    obstacles = Obstacles(np.c_[xy, 0.05 * xy[:, 0] + on_stone], 5.0)
    samples = rng.uniform(-0.4, 0.4, (60, 3))
    T = np.array(
        [pose(exp_so3(rng.normal(0, 1, 3)), rng.uniform(-6, 6, 3) * (1, 1, 0.2)) for _ in range(90)]
    )
    is_low, sunk_m = obstacles.survey(T, samples)
    points = np.array([transform(one, samples) for one in T])
    assert (is_low == (obstacles.clearances(points).min(axis=1) < 0)).all()
    assert is_low.any()
    assert not is_low.all()
    depths = obstacles.depths_in_ground(points).max(axis=1)
    np.testing.assert_allclose(sunk_m[is_low], depths[is_low], atol=1e-12)
    assert (sunk_m[~is_low] == -np.inf).all()
