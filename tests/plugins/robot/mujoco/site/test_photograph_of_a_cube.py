"""A box on a slope, photographed: each pixel has the texture of what its ray meets, in the light of
the sun and of the camera's lamp.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mujoco.egl
import numpy as np
import pytest
from executive_plugins.robot.mujoco.site import photographs
from executive_plugins.robot.mujoco.site.photographs import photograph_site
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.surface_texture import TexturedMesh
from executive_plugins.robot.mujoco.site.terrain import Terrain

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3

# Wider than MuJoCo's buffer is unless it is told; the ground fills the middle.
SIZE, ANGLE = (700, 48), 2.58
BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * [0.6, 0.4, 0.3]
# Two triangles a side, counter-clockwise from outside.
SIDES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)  # fmt: skip
T_WORLD_STONE = pose(exp_so3(np.array([0.0, 0.0, 0.5])), np.array([0.3, -0.2, 0.15]))
DOWN = np.diag([1.0, -1.0, -1.0])  # the picture's top is to the north
# Of the sun: `add_daylight`; MuJoCo's lamp at the camera adds 0.4, and 0.1 from everywhere.
SUN, TO_SUN = np.array([0.75, 0.72, 0.66]), np.array([0.5, -0.35, 0.8]) / np.sqrt(1.0125)
LAMP, AMBIENT = 0.4, 0.1


def site() -> Site:
    """Return a level square of 2 m with a box on it."""
    axis = np.linspace(-1, 1, 9)
    stone = StoneModel.from_skin("stone_1", (BOX, SIDES), 2600.0)
    return Site(Terrain(axis, np.zeros((9, 9))), (stone,), (T_WORLD_STONE,))


def rays(T: Float) -> Float:
    """Return the ray of each pixel in the world, shape (height, width, 3), with a depth of one."""
    focal_px = SIZE[0] / 2 / np.tan(ANGLE / 2)
    u, v = np.meshgrid(*(np.arange(n) + 0.5 - n / 2 for n in SIZE))
    return np.asarray(np.stack([u, v, np.full(u.shape, focal_px)], axis=-1) @ T[:3, :3].T)


def on_level(T: Float, height_m: float) -> Float:
    """Return where each pixel's ray crosses a level, shape (height, width, 3)."""
    ray = rays(T)
    return np.asarray(T[:3, 3] + ray * ((height_m - T[2, 3]) / ray[..., 2:]))


@dataclass
class Made:
    """The textures that the pictures were made with, and how often each screen was freed."""

    skins: list[TexturedMesh]
    freed: dict[mujoco.egl.GLContext, int]

    def keep(self, make: Callable[..., TexturedMesh]) -> Callable[..., TexturedMesh]:
        def kept(*given: Any) -> TexturedMesh:
            self.skins.append(make(*given))
            return self.skins[-1]

        return kept


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Made:
    made = Made([], {})

    class Counted(mujoco.egl.GLContext):
        def make_current(self) -> None:
            made.freed[self] = 0
            super().make_current()

        def free(self) -> None:
            made.freed[self] += 1
            super().free()

    for name in ("ground_skin", "stone_skin"):
        monkeypatch.setattr(photographs, name, made.keep(getattr(photographs, name)))
    monkeypatch.setattr(mujoco.egl, "GLContext", Counted)
    return made


def texels(texture: np.ndarray, uv: Float) -> Float:
    """Return the mean colour of 3 x 3 texels about coordinates (N, 2); the last row is v = 0."""
    height, width, _ = texture.shape
    upright, size = texture[::-1], np.array([width, height])
    column, row = np.clip(uv * size, 1, size - 2).astype(int).T
    near = [upright[row + i, column + j] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return np.asarray(np.mean(near, axis=0))


def test_a_pixel_has_the_texture_and_the_light_of_what_its_ray_meets(made: Made) -> None:
    tilted = pose(DOWN @ exp_so3(np.array([0.1, -0.15, 0.4])), np.array([0.4, -0.4, 2.0]))
    above = pose(DOWN, np.array([0.0, 0.0, 2.0]))
    poses = [above, tilted]
    pictures = list(photograph_site(site(), (T_WORLD_STONE,), poses, SIZE, ANGLE))
    ground, stone = made.skins
    for T, picture in zip(poses, pictures, strict=True):
        assert picture.shape == (*SIZE[::-1], 3)
        in_stone = transform(inverse(T_WORLD_STONE), on_level(T, 0.3).reshape(-1, 3))
        is_top = (np.abs(in_stone[:, :2]) < np.array([0.3, 0.2]) - 0.03).all(axis=1)
        in_stone = transform(inverse(T_WORLD_STONE), on_level(T, 0.0).reshape(-1, 3))
        is_ground = np.linalg.norm(in_stone[:, :2], axis=1) > 0.75
        xy = on_level(T, 0.0)[..., :2].reshape(-1, 2)
        colours = picture.reshape(-1, 3).astype(float)
        # A tenth of the ground is missing at the rim of the second picture.
        is_ground &= (np.abs(xy) < 0.97).all(axis=1)
        assert is_top.sum() > 150
        assert is_ground.sum() > 400
        seen, lit = colours[is_ground], texels(ground.texture, (xy[is_ground] + 1) / 2)
        assert np.corrcoef(seen[:, 1], lit[:, 1])[0, 1] > 0.9
        light = SUN * TO_SUN[2] + AMBIENT - LAMP * T[2, 2]  # the lamp shines along the axis
        assert (seen.mean(axis=0) / (lit * light).mean(axis=0)) == pytest.approx(1, abs=0.02)
        grey = colours[is_top]
        assert np.ptp(grey.mean(axis=0) / [158, 156, 150]) < 0.15
    assert stone.texture.shape == (300, 450, 3)
    assert list(made.freed.values()) == [1]
