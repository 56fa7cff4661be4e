"""A world of stones on ground: what moves, what stands, when it rests, how high the ground is."""

import numpy as np
import pytest
from executive_plugins.physics.even_directions import even_directions
from executive_plugins.physics.stone_world import StoneWorld, WorldRules, world_of

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.building import StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.testing.exercises.building import bare, box

RULES = WorldRules(step_s=0.005, pieces=1)
LEVEL = HeightGrid.plane(np.full(2, -4.0), np.full(2, 4.0))
CUBE = box("cube", 0.4, 0.4, 0.4)


def at(x: float, y: float, z: float, yaw_rad: float = 0.0) -> StandingStone:
    return StandingStone(CUBE, pose(from_rpy(0.0, 0.0, yaw_rad), np.array([x, y, z])))


def places(world: StoneWorld, count: int) -> Float:
    return np.array([world.pose_of(number)[:3, 3] for number in range(count)])


def test_a_stone_in_the_air_falls_on_the_ground_and_a_fixed_one_stays_there() -> None:
    stones = [at(0.0, 0.0, 2.0), at(2.0, 0.0, 0.21)]
    world = StoneWorld(LEVEL, stones, [True, False], RULES)
    assert list(world.free) == [1]
    assert world.settle(0.2, 3.0)
    np.testing.assert_array_equal(world.pose_of(0), stones[0].T_map_stone)
    np.testing.assert_allclose(world.pose_of(1)[:3, 3], [2.0, 0.0, 0.2], atol=2e-3)
    standing = world.standing(stones)
    assert [one.stone for one in standing] == [CUBE, CUBE]
    np.testing.assert_array_equal(standing[1].T_map_stone, world.pose_of(1))


def test_the_pose_of_a_fixed_stone_is_not_for_others_to_change() -> None:
    world = StoneWorld(LEVEL, [at(0.0, 0.0, 0.2)], [True], RULES)
    world.pose_of(0)[:3, 3] = 9.0
    assert world.pose_of(0)[2, 3] == 0.2


def test_free_fall_is_that_of_galilei() -> None:
    """After 0.2 s: g t of speed, and g t² / 2 of way (semi-implicit steps add g t dt / 2)."""
    world = StoneWorld(LEVEL, [at(0.0, 0.0, 3.0)], None, RULES)
    world.step(40)
    assert world.speed() == pytest.approx(9.81 * 0.2, rel=0.01)
    way_m = 3.0 - world.pose_of(0)[2, 3]
    assert way_m == pytest.approx(0.5 * 9.81 * 0.2**2 + 0.5 * 9.81 * 0.2 * 0.005, rel=0.01)


def test_a_stone_is_put_somewhere_at_rest_and_no_other_one_moves() -> None:
    world = StoneWorld(LEVEL, [at(-1.0, 0, 3.0), at(1.0, 0, 3.0), at(0, 2.0, 3.0)], None, RULES)
    world.step(20)
    before, falling = places(world, 3), np.array(world.data.qvel)
    there = pose(from_rpy(0.1, 0.2, 0.3), np.array([0.5, -1.5, 2.0]))
    world.set_pose(1, there)
    np.testing.assert_allclose(world.pose_of(1), there, atol=1e-12)
    after = places(world, 3)
    np.testing.assert_array_equal(after[[0, 2]], before[[0, 2]])
    np.testing.assert_array_equal(world.data.qvel[6:12], 0.0)
    np.testing.assert_array_equal(
        world.data.qvel[[*range(6), *range(12, 18)]], falling[[*range(6), *range(12, 18)]]
    )


def test_numbers_are_those_of_all_stones_though_some_are_fixed() -> None:
    stones = [at(-1.0, 0, 0.2), at(1.0, 0, 0.2), at(0, 2.0, 0.2)]
    world = StoneWorld(LEVEL, stones, [False, True, False], RULES)
    there = pose(t=np.array([0.5, -1.5, 2.0]))
    world.set_pose(2, there)
    np.testing.assert_allclose(world.pose_of(2), there, atol=1e-12)
    np.testing.assert_allclose(world.pose_of(0), stones[0].T_map_stone, atol=1e-12)


def test_a_fall_is_not_at_rest_before_its_time_is_over() -> None:
    world = StoneWorld(LEVEL, [at(0.0, 0.0, 3.5)], None, RULES)
    assert not world.settle(0.1, 0.3)
    assert world.data.time == pytest.approx(0.3, abs=0.06)
    assert world.settle(0.1, 5.0)


def test_a_stone_that_rests_is_watched_for_the_least_time() -> None:
    world = StoneWorld(LEVEL, [at(0.0, 0.0, 0.2)], None, RULES)
    assert world.settle(1.0, 3.0)
    assert world.data.time == pytest.approx(1.0, abs=0.06)


def test_settling_ends_when_nothing_more_is_of_interest() -> None:
    world, asked = StoneWorld(LEVEL, [at(0.0, 0.0, 0.2)], None, RULES), []

    def is_over() -> bool:
        asked.append(float(world.data.time))
        return len(asked) == 3

    assert not world.settle(0.0, 3.0, still=0.0, is_over=is_over)
    assert asked == pytest.approx([0.05, 0.1, 0.15])


def test_a_stone_that_shakes_on_the_spot_rests() -> None:
    """Its speed is never below none at all; it has not strayed for half a second."""
    world = StoneWorld(LEVEL, [at(0.0, 0.0, 0.2)], None, RULES)
    assert world.settle(0.0, 3.0, still=0.0)
    assert world.data.time == pytest.approx(0.5, abs=0.06)


def test_a_stone_slides_down_a_slope_that_is_steeper_than_its_friction() -> None:
    """Friction 0.3 holds on 10° (tan 0.18) and not on 25° (0.47)."""
    ways = []
    for slope_rad in np.radians([10.0, 25.0]):
        ground = HeightGrid.plane(np.full(2, -4.0), np.full(2, 4.0), slope_rad)
        turned = from_rpy(0.0, -slope_rad, 0.0)
        stone = StandingStone(CUBE, pose(turned, turned @ np.array([0.0, 0.0, 0.2])))
        world = StoneWorld(ground, [stone], None, WorldRules(step_s=0.005, friction=0.3, pieces=1))
        world.step(200)
        ways.append(-world.pose_of(0)[0, 3])
    assert abs(ways[0]) < 0.05
    assert ways[1] > 0.3


@pytest.mark.parametrize(("x", "y"), [(-1.5, 1.0), (1.0, -1.5)])
def test_stones_come_to_rest_on_the_steps_of_a_height_field(x: float, y: float) -> None:
    """Ground of 0.3 m at x < 0 and of 0.7 m at y < −1, longer along y than along x."""
    i, j = np.indices((17, 25))
    heights = np.where(j * 0.25 - 3.0 < -1.0, 0.7, np.where(i * 0.25 - 2.0 < 0.0, 0.3, 0.0))
    ground = HeightGrid(np.array([-2.0, -3.0]), 0.25, heights)
    expected = 0.7 if y < -1.0 else 0.3
    world = StoneWorld(ground, [at(x, y, expected + 0.21)], None, RULES)
    assert world.settle(0.3, 3.0)
    np.testing.assert_allclose(world.pose_of(0)[:3, 3], [x, y, expected + 0.2], atol=0.01)


def test_the_world_of_a_structure_lets_all_its_stones_move() -> None:
    built = bare().with_standing(at(0.0, 0.0, 0.2), at(0.0, 1.0, 0.2))
    world = world_of(built, RULES)
    assert list(world.free) == [0, 1]
    np.testing.assert_allclose(places(world, 2), [[0, 0, 0.2], [0, 1, 0.2]], atol=1e-12)


def test_a_heavier_stone_has_the_mass_and_inertia_of_its_shape() -> None:
    """Of a cuboid: m (b² + c²) / 12."""
    stone = box("slab", 0.8, 0.4, 0.2)
    world = StoneWorld(LEVEL, [StandingStone(stone, pose(t=np.array([0.0, 0, 1.0])))], None, RULES)
    body = world.model.body("stone_0")
    assert float(body.mass[0]) == pytest.approx(stone.mass_kg)
    expected = stone.mass_kg / 12 * np.array([0.4**2 + 0.2**2, 0.8**2 + 0.2**2, 0.8**2 + 0.4**2])
    np.testing.assert_allclose(np.sort(body.inertia), np.sort(expected), rtol=0.02)


@pytest.mark.parametrize(("dent_m", "rolls"), [(0.0, True), (0.05, False)])
def test_a_round_stone_rolls_down_a_gentle_slope_unless_the_ground_gives_way(
    dent_m: float, rolls: bool
) -> None:
    """The dent of 5 cm holds a stone of 0.4 m radius up to a slope of 4 a / (3 π r), or 3°."""
    angles = np.linspace(0.0, 2.0 * np.pi, 240, endpoint=False)
    rim = 0.4 * np.column_stack([np.cos(angles), np.zeros(240), np.sin(angles)])
    corners, triangles = hull_mesh(np.vstack([rim + [0.0, y, 0.0] for y in (-0.3, 0.3)]))
    wheel = StandingStone(SolidStone("wheel", corners, triangles, 700.0), pose(t=[0.0, 0.0, 0.401]))
    slope = HeightGrid.plane(np.array([-5.0, -5.0]), np.array([5.0, 5.0]), np.radians(2.0))
    rules = WorldRules(friction=0.7, pieces=1, dent_m=dent_m)
    world = StoneWorld(slope, [wheel], None, rules)
    world.step(500)
    assert (float(np.abs(places(world, 1)[0, 0])) > 0.2) is rolls


def test_a_convex_stone_is_one_piece_where_that_is_asked_for() -> None:
    def pieces(stone: SolidStone, is_convex_whole: bool) -> int:
        rules = WorldRules(pieces=10, is_convex_whole=is_convex_whole)
        there = StandingStone(stone, pose(t=np.array([0.0, 0.0, 1.0])))
        return int(StoneWorld(LEVEL, [there], None, rules).model.ngeom) - 1  # without the ground

    corners, triangles = hull_mesh(even_directions(200))
    dented = corners * np.where(corners[:, 2:] > 0.8, 0.7, 1.0)
    ball = SolidStone.of_mesh("ball", corners, triangles, 2600.0)
    hollow = SolidStone.of_mesh("hollow", dented, triangles, 2600.0)
    assert (pieces(ball, True), pieces(ball, False)) == (1, 10)
    assert (pieces(hollow, True), pieces(hollow, False)) == (10, 10)
