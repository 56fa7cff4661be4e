"""Photographs show the site that lidars see: each pixel the surface that its ray hits; and they
change nothing.
"""

import numpy as np
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.site import photographs
from executive_plugins.robot.mujoco.site.surface_texture import ground_skin, stone_skin

from executive.errors import RobotError
from executive.geometry.pose import pose
from executive.machine.machine import load_machine

SIZE, ANGLE = (320, 240), 1.2
SITE = {"terrain": {"half_size_m": 9}, "stones": {"count": 3}}
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
# Two triangles a side, counter-clockwise from outside.
SIDES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


def robot(seed: int = 3) -> MujocoRobot:
    settings = MujocoSettings.model_validate({"site": SITE})
    made = MujocoRobot(settings, load_machine("m545"), np.random.default_rng(seed))
    made.start()
    return made


def above(x: float, y: float, height: float) -> np.ndarray:
    """Return T_world_optical of a camera that looks down, its picture's top to the north."""
    return pose(np.diag([1.0, -1.0, -1.0]), np.array([x, y, height]))


def rays(T: np.ndarray) -> np.ndarray:
    """Return the unit ray of each pixel in the world, shape (height · width, 3)."""
    width, height = SIZE
    focal = width / 2 / np.tan(ANGLE / 2)
    u, v = np.meshgrid(
        (np.arange(width) + 0.5 - width / 2) / focal, (np.arange(height) + 0.5 - height / 2) / focal
    )
    in_camera = np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=1)
    return (in_camera / np.linalg.norm(in_camera, axis=1, keepdims=True)) @ T[:3, :3].T


def test_a_picture_shows_stones_where_rays_meet_them() -> None:
    made = robot()
    middle = np.mean([T[:3, 3] for T in made.world.site.T_world_stones], axis=0)
    T = above(middle[0], middle[1], 9.0)
    picture = next(iter(made.photograph([T], SIZE, ANGLE))).astype(float)
    directions = rays(T)
    origins = np.broadcast_to(T[:3, 3], directions.shape)
    ranges = made.cast_rays(origins, directions)
    height = origins[:, 2] + ranges * directions[:, 2]
    is_stone = (height > 0.35).reshape(SIZE[::-1])
    is_ground = ((height < 0.2) & np.isfinite(ranges)).reshape(SIZE[::-1])
    # Ground is brown, stones are grey: red over blue tells them apart at any brightness.
    ratio = picture[..., 0] / np.maximum(picture[..., 2], 1)
    split = (1.0 + 134 / 86) / 2
    assert is_stone.sum() > 800
    assert (ratio[is_stone] < split).mean() > 0.97
    assert (ratio[is_ground] > split).mean() > 0.97


def test_one_site_has_the_same_pictures_every_time_and_another_has_others() -> None:
    poses = [above(4, 0, 7)]
    first, again, other = (list(robot(seed).photograph(poses, SIZE, ANGLE)) for seed in (3, 3, 4))
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert not np.array_equal(first[0], other[0])
    assert all(picture.shape == (240, 320, 3) and picture.dtype == np.uint8 for picture in first)
    assert first[0].std() > 10


def test_photographs_leave_the_world_as_it_is() -> None:
    made, untouched = robot(), robot()
    list(made.photograph([above(4, 0, 7)], SIZE, ANGLE))
    for one in (made, untouched):
        one.read(0.2)
    assert made.world.model.ntex == untouched.world.model.ntex
    assert np.array_equal(made.world.data.qpos, untouched.world.data.qpos)


def test_a_computer_that_cannot_draw_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    import mujoco.egl

    class NoScreen:
        def __init__(self, width: int, height: int) -> None:
            raise RuntimeError("no display")

    monkeypatch.setattr(mujoco.egl, "GLContext", NoScreen)
    with pytest.raises(
        RobotError, match=r"cannot render off screen \(no display\); install EGL.*libegl1"
    ):
        photographs._screen(SIZE)


def test_each_side_of_a_stone_has_a_picture_of_its_own() -> None:
    skin = stone_skin((CUBE, SIDES), np.random.default_rng(0))
    middles = skin.coordinates.reshape(-1, 3, 2).mean(axis=1)
    tiles = {tuple(np.floor(middle * [3, 2]).astype(int)) for middle in middles}
    assert len(tiles) == 6
    assert (skin.coordinates >= 0).all()
    assert (skin.coordinates <= 1).all()
    # True to size: a side of one metre is a third of the texture's width, and has the same number
    # of texels each way.
    corners = skin.coordinates.reshape(-1, 3, 2)
    assert np.allclose(np.ptp(corners[..., 0], axis=1) * 3, 0.998)
    assert np.allclose(np.ptp(corners[..., 1], axis=1) * 2, 0.998)
    assert skin.texture.shape[1] * 2 == skin.texture.shape[0] * 3


def test_the_ground_has_one_texture_with_detail_at_every_distance() -> None:
    flat = (CUBE[::2] * [4, 4, 0], np.array([[0, 2, 3], [0, 3, 1]]))
    texture = ground_skin(flat, np.random.default_rng(0)).texture[..., 1].astype(float)
    for block in (1, 4, 16):
        side = len(texture) // block * block
        coarse = texture[:side, :side].reshape(side // block, block, -1, block).mean(axis=(1, 3))
        assert coarse.std() > 4
