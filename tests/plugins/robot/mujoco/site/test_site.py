"""A site: level under the machine, rough elsewhere, its stones at rest where they may lie."""

import mujoco
import numpy as np
import pytest
from executive_plugins.physics.scenario import contact_of
from executive_plugins.robot.mujoco.physics import apply_physics
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import (
    SiteSettings,
    StoneSettings,
    TerrainSettings,
)
from executive_plugins.robot.mujoco.site.site import Site, add_daylight, make_site
from executive_plugins.robot.mujoco.site.stone_placement import footprint, gap
from executive_plugins.robot.mujoco.site.terrain import TERRAIN, make_terrain

from executive.errors import ConfigError
from executive.geometry.pose import transform
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import load_machine

MACHINE = load_machine("m545")
SMALL = {"half_size_m": 10}


def site(seed: int = 0, **settings: object) -> Site:
    chosen = SiteSettings.model_validate({"terrain": SMALL, **settings})
    return make_site(chosen, MACHINE, PhysicsSettings(), np.random.default_rng(seed))


def world(of: Site) -> tuple[mujoco.MjModel, mujoco.MjData]:
    spec = mujoco.MjSpec()
    of.add_to(spec)
    apply_physics(spec, PhysicsSettings(), contact_of("kind", MACHINE.gripper))
    model = spec.compile()
    return model, mujoco.MjData(model)


def test_the_ground_is_level_under_the_machine_and_as_rough_as_asked_elsewhere() -> None:
    settings = TerrainSettings(undulation_m=0.05, roughness_m=0.01, pad_radius_m=3)
    terrain = make_terrain(settings, np.random.default_rng(0))
    x, y = np.meshgrid(terrain.coordinates_m, terrain.coordinates_m, indexing="ij")
    radius = np.hypot(x, y)
    assert np.abs(terrain.heights_m[radius < 3]).max() < 1e-12
    # √(0.05² + 0.01²) = 0.051 m, over some 40 independent waves.
    assert terrain.heights_m[radius > 5].std() == pytest.approx(0.051, abs=0.012)
    assert len(np.unique(np.round(np.diff(terrain.coordinates_m), 9))) == 1


def test_rays_physics_and_formula_agree_on_the_height_of_the_ground() -> None:
    ground = site(
        stones={"count": 0}, terrain={"half_size_m": 10, "undulation_m": 0.3, "roughness_m": 0.05}
    ).terrain
    model, data = world(Site(ground, (), ()))
    mujoco.mj_forward(model, data)
    vertices, triangles = ground.mesh()
    rng = np.random.default_rng(0)
    for x, y in rng.uniform(-9, 9, (50, 2)):
        geom, normal = np.zeros(1, np.int32), np.zeros(3)
        down = mujoco.mj_ray(
            model, data, np.array([x, y, 9.0]), np.array([0, 0, -1.0]), None, 1, -1, geom, normal
        )
        assert model.geom(int(geom[0])).name == TERRAIN
        # The triangle of the mesh over which the point lies.
        a, b, c = (vertices[triangles[:, k], :2] for k in range(3))
        u, v = np.linalg.solve(
            np.stack([b - a, c - a], axis=-1), (np.array([x, y]) - a)[..., None]
        )[..., 0].T
        k = int(np.flatnonzero((u >= 0) & (v >= 0) & (u + v <= 1))[0])
        corners = vertices[triangles[k], 2]
        height = corners[0] + u[k] * (corners[1] - corners[0]) + v[k] * (corners[2] - corners[0])
        assert 9 - down == pytest.approx(
            height, abs=1e-4
        )  # the same split of cells; single precision
        assert 9 - down == pytest.approx(float(ground.height_at(np.array([[x, y]]))[0]), abs=0.05)


def test_stones_lie_in_their_sector_with_gaps_on_the_ground() -> None:
    made = site(seed=2)
    assert len(made.stones) == 7
    outlines = []
    for stone, T in zip(made.stones, made.T_world_stones, strict=True):
        radius, azimuth = np.hypot(*T[:2, 3]), np.arctan2(T[1, 3], T[0, 3])
        assert (
            0.45 * MACHINE.reach_m - 0.3 < radius < 0.75 * MACHINE.reach_m + 0.3
        )  # they roll a little
        assert abs(azimuth) < 1.4 + 0.1
        corners = transform(T, stone.hull)
        clearance = (corners[:, 2] - made.terrain.height_at(corners[:, :2])).min()
        assert abs(clearance) < 0.02  # contacts are soft, cells are split along one diagonal
        outlines.append(footprint(corners))
    assert min(gap(a, b) for i, a in enumerate(outlines) for b in outlines[:i]) >= 0.4


def test_stones_are_at_rest_when_the_mission_begins() -> None:
    made = site(seed=1)
    model, data = world(made)
    start = data.qpos.reshape(-1, 7).copy()
    while data.time < 2:
        mujoco.mj_step(model, data)
    moved = np.linalg.norm(data.qpos.reshape(-1, 7)[:, :3] - start[:, :3], axis=1)
    assert moved.max() < 0.02


def test_masses_and_inertias_in_the_world_are_those_of_the_stones() -> None:
    made = site()
    model, _ = world(made)
    for stone in made.stones:
        body = model.body(stone.name)
        assert body.mass[0] == pytest.approx(stone.mass_kg)
        assert np.allclose(np.sort(body.inertia), np.linalg.eigvalsh(stone.inertia), rtol=1e-6)
        assert np.allclose(body.ipos, 0)


def test_one_seed_gives_one_site_bit_for_bit() -> None:
    first, again, other = site(seed=4), site(seed=4), site(seed=5)
    assert np.array_equal(first.terrain.heights_m, again.terrain.heights_m)
    assert all(
        np.array_equal(a, b)
        for a, b in zip(first.T_world_stones, again.T_world_stones, strict=True)
    )
    assert not np.array_equal(first.T_world_stones[0], other.T_world_stones[0])


def test_an_empty_site_and_stones_out_of_reach_are_sites_too() -> None:
    assert site(stones={"count": 0}).T_world_stones == ()
    placement = {"min_radius_m": 16, "max_radius_m": 18}
    far = site(stones={"count": 2, "placement": placement}, terrain={"half_size_m": 20})
    assert all(np.hypot(*T[:2, 3]) > 15.5 for T in far.T_world_stones)


def test_says_that_there_is_no_room() -> None:
    with pytest.raises(
        ConfigError, match=r"no room for 60 stones .* lower count or gap_m, or widen"
    ):
        site(stones={"count": 60})
    with pytest.raises(ConfigError, match=r"min_radius_m 9 is beyond max_radius_m 6\.75"):
        site(stones={"placement": {"min_radius_m": 9}})


def test_gap_of_outlines_is_their_distance() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert gap(square, square + np.array([1.5, 0.3])) == pytest.approx(0.5)
    assert gap(square, square + np.array([2.0, 2.0])) == pytest.approx(np.sqrt(2))
    assert gap(square, square + np.array([0.5, 0.5])) == 0.0
    assert gap(square, 0.2 * square + 0.4) == 0.0  # one inside the other


def masses_beyond_capacity(site: Site) -> list[float]:
    capacity, heavy = LiftCapacity(MACHINE), []
    for stone, T in zip(site.stones, site.T_world_stones, strict=True):
        x, y = T[:2, 3]
        there = capacity.near(float(np.hypot(x, y)), float(np.arctan2(y, x)))
        # Stones roll by some centimetres when they are dropped, hence 5 %.
        if there is None or stone.mass_kg > 1.05 * there.rated_kg:
            heavy.append(stone.mass_kg)
    return heavy


def test_stones_lie_where_the_machine_may_lift_them() -> None:
    physics, few = PhysicsSettings(), StoneSettings(count=4)
    stance = MACHINE.stance.model_copy(update={"is_free": True})
    may_tip = MACHINE.model_copy(update={"stance": stance})
    for machine, scenario, is_liftable, has_heavy in (
        (MACHINE, "kind", None, True),
        (MACHINE, "nominal", None, False),
        (MACHINE, "kind", True, False),
        (may_tip, "kind", None, False),
        (may_tip, "kind", False, True),
    ):
        settings = SiteSettings(stones=few, liftable=is_liftable)
        drawn = make_site(settings, machine, physics, np.random.default_rng(6), scenario)
        assert bool(masses_beyond_capacity(drawn)) is has_heavy, scenario


def test_a_stone_that_the_machine_may_lift_nowhere_is_refused() -> None:
    stones = StoneSettings(count=1, volume_m3=(2.0, 2.0))
    with pytest.raises(ConfigError, match=r"stone_1 weighs 5\d+ kg, which the machine may lift"):
        make_site(
            SiteSettings(stones=stones),
            MACHINE,
            PhysicsSettings(),
            np.random.default_rng(1),
            "nominal",
        )


def test_daylight_falls_from_a_sky_that_a_picture_can_show() -> None:
    """Colours are shares of full light; the sky is blue above and brighter at the horizon."""
    spec = mujoco.MjSpec()
    add_daylight(spec)
    model = spec.compile()
    assert model.light_dir[0, 2] < -0.5
    assert model.light_castshadow[0]
    assert ((model.light_diffuse > 0.5) & (model.light_diffuse <= 1)).all()
    (sky,) = spec.textures
    for colour in (sky.rgb1, sky.rgb2):
        assert (np.asarray(colour) <= 1).all()
        assert (np.diff(colour) > 0).all()  # more blue than green, and more green than red
    assert (np.asarray(sky.rgb2) > sky.rgb1).all()
    assert sky.height == 6 * sky.width  # six faces of a cube
