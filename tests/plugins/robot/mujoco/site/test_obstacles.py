"""Walls, trunks and slopes: rays and contacts meet them where they were put, stones keep off."""

import mujoco
import numpy as np
import pytest
from executive_plugins.physics.scenario import contact_of
from executive_plugins.robot.mujoco.physics import apply_physics
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import SiteSettings, TerrainSettings
from executive_plugins.robot.mujoco.site.site import Site, make_site
from executive_plugins.robot.mujoco.site.site_scene import SiteScene
from executive_plugins.robot.mujoco.site.stone_placement import footprint, gap
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.truth.contact_log import ContactLog
from executive_plugins.robot.mujoco.world import World

from executive.errors import ConfigError
from executive.geometry.pose import transform
from executive.machine.machine import load_machine

MACHINE = load_machine("m545")
LEVEL = {"half_size_m": 12, "undulation_m": 0, "roughness_m": 0}
WALL = {"at_m": (6, 0), "size_m": (4, 0.4, 2), "yaw_rad": np.pi / 2}
TRUNK = {"shape": "cylinder", "at_m": (0, 7), "size_m": (0.6, 0.6, 5)}


def site(**settings: object) -> Site:
    chosen = SiteSettings.model_validate({"terrain": LEVEL, **settings})
    return make_site(chosen, MACHINE, PhysicsSettings(), np.random.default_rng(3))


def test_rays_meet_a_wall_and_a_trunk_where_the_mission_put_them() -> None:
    scene = SiteScene(site(stones={"count": 0}, obstacles=[WALL, TRUNK]))
    eye = np.array([[0.0, 0, 1.5]] * 4)
    towards = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [np.cos(0.4), np.sin(0.4), 0]])
    ranges = scene.cast_rays(eye, towards)
    assert ranges[0] == pytest.approx(5.8, abs=1e-4)  # 6 m less half of its width
    assert ranges[1] == pytest.approx(6.7, abs=0.01)  # 7 m less the radius of the trunk
    assert np.isinf(ranges[2:]).all()  # behind, and beside the end of the wall
    assert scene.cast_rays(np.array([[6.0, 0, 9]]), np.array([[0.0, 0, -1]])) == pytest.approx(7.0)


def test_a_body_that_falls_onto_a_wall_stays_on_its_top() -> None:
    spec = mujoco.MjSpec()
    site(stones={"count": 0}, obstacles=[WALL]).add_to(spec)
    body = spec.worldbody.add_body(name="ball", pos=[6.0, 0.0, 2.3])
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.1])
    apply_physics(spec, PhysicsSettings(), contact_of("kind", MACHINE.gripper))
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(800):
        mujoco.mj_step(model, data)
    assert data.body("ball").xpos[2] == pytest.approx(2.1, abs=0.01)


def test_stones_keep_their_gap_to_obstacles() -> None:
    made = site(stones={"count": 4}, obstacles=[WALL])
    (wall,) = made.obstacles
    outlines = [
        footprint(transform(T, stone.hull))
        for stone, T in zip(made.stones, made.T_world_stones, strict=True)
    ]
    assert all(gap(outline, footprint(wall.mesh()[0])) >= 0.4 for outline in outlines)


def test_a_site_without_room_beside_its_obstacles_is_refused() -> None:
    with pytest.raises(ConfigError, match="no room for 2 stones"):
        site(stones={"count": 2}, obstacles=[{"at_m": (4, 0), "size_m": (20, 20, 1)}])


def test_an_obstacle_without_height_is_refused() -> None:
    with pytest.raises(ValueError, match=r"size_m is within 0\.05 to 100 m a side"):
        SiteSettings.model_validate({"obstacles": [{"at_m": (4, 0), "size_m": (2, 1, 0)}]})


def test_a_slope_rises_uphill_around_a_level_terrace() -> None:
    settings = TerrainSettings.model_validate(
        {**LEVEL, "slope_rad": 0.1, "uphill_rad": np.pi / 2, "pad_radius_m": 3}
    )
    terrain = make_terrain(settings, np.random.default_rng(0))
    heights = terrain.height_at(np.array([[0.0, 10], [0, -10], [10, 0], [0, 2.5]]))
    assert heights == pytest.approx([10 * np.tan(0.1), -10 * np.tan(0.1), 0, 0], abs=1e-9)


def test_the_truth_tells_a_contact_with_an_obstacle_by_its_name() -> None:
    palm = World(MACHINE, site(stones={"count": 0}), PhysicsSettings()).T_world_body(
        MACHINE.gripper_link
    )[:3, 3]
    post = {"at_m": tuple(palm[:2]), "size_m": (0.3, 0.3, float(palm[2]))}
    world = World(MACHINE, site(stones={"count": 0}, obstacles=[WALL, post]), PhysicsSettings())
    log = ContactLog(MACHINE, (), world.model)
    log.step(0.0, world.model, world.data)
    touched = {span.other for span in log.spans()}
    assert "obstacle_2" in touched
    assert not touched & {"obstacle_1", "terrain"}
