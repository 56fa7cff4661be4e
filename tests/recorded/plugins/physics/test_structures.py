"""Balance, pieces, worlds and releases of stones on one another."""

import numpy as np
import pytest
from executive_plugins.physics.convex_pieces import convex_pieces
from executive_plugins.physics.equilibrium import Touch, largest_load
from executive_plugins.physics.stone_world import WorldRules, world_of
from executive_plugins.physics.trial import Trial, apart, disturbed, rest_of, touches_of

from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.building import StandingStone
from executive.testing.exercises.building import bare, box, first_course

# The contact engine stops its iterations at a tolerance of its own.
SETTLED = 1e-4
RULES = WorldRules(step_s=0.004, friction=0.6, pieces=1)


def corners(x: float, z: float, half_m: float) -> np.ndarray:
    return np.array([[x + sx * half_m, sy * half_m, z] for sx in (-1, 1) for sy in (-1, 1)])


def touches(first: int, second: int, points: np.ndarray, normal=(0.0, 0.0, 1.0)) -> list[Touch]:
    return [Touch(first, second, point, np.array(normal)) for point in points]


def test_loads(recorded) -> None:
    """One block, a tower, a leaning block, and a block that nothing bears."""
    told = []
    tower = [*touches(-1, 0, corners(0, 0, 0.3)), *touches(0, 1, corners(0.1, 0.5, 0.2))]
    wedge = [
        *touches(-1, 0, corners(0, 0, 0.3)[:2], (0.6, 0.0, 0.8)),
        *touches(-1, 0, corners(0, 0, 0.3)[2:], (-0.8, 0.0, 0.6)),
    ]
    centres = np.array([[0.0, 0.0, 0.25], [0.1, 0.0, 0.75]])
    for those, count in (
        (tower[:4], 1),
        (tower, 2),
        (wedge, 1),
        ([], 1),
        (tower[:1], 1),
        (touches(-1, 0, corners(0.9, 0, 0.3)), 1),
    ):
        for friction in (0.0, 0.4, 3.0):
            for angle in (0.0, 1.0, np.pi / 2):
                towards = np.array([np.cos(angle), np.sin(angle), 0.0])
                masses = np.array([800.0, 300.0])[:count]
                told.append(largest_load(those, centres[:count], masses, friction, towards))
    recorded(told, relative=1e-6)


def test_pieces(recorded) -> None:
    rng, told = np.random.default_rng(1), []
    points = rng.normal(size=(40, 3))
    vertices, triangles = hull_mesh(points / np.linalg.norm(points, axis=1)[:, None])
    vertices = vertices - vertices.mean(axis=0)
    for count in (1, 2, 6, 24):
        pieces = convex_pieces(vertices, triangles, count)
        told.append([(len(one), one.mean(axis=0), np.ptp(one, axis=0)) for one in pieces])
    recorded(told)


def leaning(x: float, tilt_rad: float) -> np.ndarray:
    return pose(from_rpy(0.0, tilt_rad, 0.2), np.array([x, 0.0, 0.62]))


@pytest.mark.parametrize("fixed", [False, True])
def test_releases(recorded, fixed) -> None:
    course = first_course()
    rest, told = rest_of(course, RULES), []
    trial = Trial(course, box("top", 0.8, 0.6, 0.3), RULES, rest, [fixed] * 3)
    for x, tilt_rad, height_m in ((0.5, 0.0, 0.02), (0.5, 0.3, 0.1), (1.7, 0.0, 0.0)):
        found = trial.release(leaning(x, tilt_rad), height_m)
        told += [found.T_map_release, found.is_at_rest, np.round(found.T_map_settled, 3)]
        told.append((round(found.moved_m, 3), len(trial.touches()) > 0))
    recorded(told, relative=SETTLED, absolute=2e-3)
    recorded([np.round(T, 3) for T in rest], absolute=2e-3)


def test_nothing_rests_where_nothing_stands(recorded) -> None:
    trial = Trial(bare(), box("first", 0.8, 0.6, 0.3), RULES)
    found = trial.release(pose(t=np.array([0.1, 0.0, 0.5])), 0.05)
    recorded((rest_of(bare(), RULES), found.T_map_release, found.moved_m, found.is_at_rest))
    assert found.T_map_settled[:3, 3] == pytest.approx([0.1, 0.0, 0.15], abs=5e-3)


def test_noise(recorded) -> None:
    T, rng = leaning(0.5, 0.1), np.random.default_rng(2)
    told = [
        disturbed(T, *noise, rng) for noise in ((0.0, 0.0), (0.05, 0.0), (0.0, 0.1), (0.1, 0.2))
    ]
    recorded((told, [apart(T, one) for one in told]))


def test_worlds(recorded) -> None:
    built = first_course().with_standing(StandingStone(box("top", 0.5, 0.5, 0.3), leaning(0.5, 0)))
    world = world_of(built, RULES)
    world.settle(0.2, 0.6)
    told = touches_of(world)
    pairs = sorted({(one.first, one.second) for one in told})
    assert all(abs(np.linalg.norm(one.normal) - 1.0) < 1e-9 for one in told)
    recorded((pairs, [np.round(world.pose_of(n)[:3, 3], 3) for n in world.free]), absolute=2e-3)
