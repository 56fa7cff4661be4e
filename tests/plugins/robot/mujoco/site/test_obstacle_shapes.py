"""Where obstacles stand on a slope, and that rays and contacts have the same shape."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.site.obstacle import Obstacle, make_obstacles
from executive_plugins.robot.mujoco.site.settings import ObstacleSettings

from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis

UP = np.array([0.0, 0.0, 1.0])
SLOPE = SimpleNamespace(height_at=lambda places: 0.1 * places[:, 0] - 0.2 * places[:, 1])


def test_a_wall_stands_on_its_highest_ground_and_is_buried_in_its_lowest() -> None:
    """Turned by 90°, a wall of 4 m by 1 m is 1 m long in x and 4 m in y."""
    wall = ObstacleSettings(at_m=(10.0, 5.0), size_m=(4.0, 1.0, 2.0), yaw_rad=np.pi / 2)
    trunk = ObstacleSettings(shape="cylinder", at_m=(0.0, 0.0), size_m=(0.6, 9.0, 5.0))
    first, second = make_obstacles([wall, trunk], SLOPE)
    assert (first.name, first.shape) == ("obstacle_1", "box")
    # Its corners are at x 9.5 and 10.5, y 3 and 7: the ground from -0.45 to 0.45 m.
    bottom, top = -0.45 - 0.5, 0.45 + 2.0
    assert first.half_size_m == pytest.approx([2.0, 0.5, (top - bottom) / 2])
    expected = pose(about_axis(UP, np.pi / 2), np.array([10.0, 5.0, (top + bottom) / 2]))
    assert first.T_world_obstacle == pytest.approx(expected)
    # A trunk is as wide as it is long: corners at ±0.3 m, the ground from -0.09 to 0.09 m.
    assert (second.name, second.shape) == ("obstacle_2", "cylinder")
    assert second.half_size_m == pytest.approx([0.3, 0.3, (5.09 + 0.59) / 2])
    assert second.T_world_obstacle[:3, 3] == pytest.approx([0.0, 0.0, (5.09 - 0.59) / 2])


@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_rays_and_contacts_meet_the_same_shape(shape: str) -> None:
    """A box exactly; a cylinder within its sixteen corners, two of them along its axes."""
    T = pose(about_axis(UP, 0.3), np.array([3.0, -2.0, 1.5]))
    half = np.array([0.6, 0.6 if shape == "cylinder" else 0.2, 1.2])
    obstacle = Obstacle("it", T, half, shape)
    vertices, triangles = obstacle.mesh()
    local = (vertices - T[:3, 3]) @ T[:3, :3]
    assert np.abs(local).max(axis=0) == pytest.approx(half)
    assert set(np.round(local[:, 2], 9)) == {-1.2, 1.2}
    if shape == "cylinder":
        assert np.hypot(local[:, 0], local[:, 1]) == pytest.approx(np.full(32, 0.6))
    a, b, c = (vertices[triangles[:, k]] - T[:3, 3] for k in range(3))
    volume_m3 = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6
    area_m2 = 0.5 * 16 * 0.6**2 * np.sin(np.pi / 8) if shape == "cylinder" else 1.2 * 0.4
    assert volume_m3 == pytest.approx(area_m2 * 2.4)
    spec = mujoco.MjSpec()
    obstacle.add_to(spec)
    model = spec.compile()
    geom = model.geom("it")
    kinds = {"box": mujoco.mjtGeom.mjGEOM_BOX, "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER}
    assert geom.type[0] == kinds[shape]
    sizes = [0.6, 1.2] if shape == "cylinder" else half  # radius and half of the height
    assert geom.size[: len(sizes)] == pytest.approx(sizes)
    assert geom.pos == pytest.approx([3.0, -2.0, 1.5])
    assert geom.quat == pytest.approx([np.cos(0.15), 0.0, 0.0, np.sin(0.15)])
    brown = [0.55, 0.36, 0.28, 1.0] if shape == "box" else [0.36, 0.27, 0.18, 1.0]
    assert geom.rgba == pytest.approx(brown)
    assert (geom.contype[0], geom.conaffinity[0], geom.bodyid[0]) == (1, 1, 0)
