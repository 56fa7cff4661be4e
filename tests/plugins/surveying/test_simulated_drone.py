"""The drone's cloud is the site but for noise, a warp and a similarity; what no camera sees is a
hole.
"""

import numpy as np
import pytest
from executive_plugins.surveying.reconstruction import own_frame, warp
from executive_plugins.surveying.settings import ReconstructionSettings, SimulatedDroneSettings
from executive_plugins.surveying.simulated_drone import SimulatedDrone
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.rigid_fit import similarity_fit
from executive.geometry.voxels import voxel_means
from executive.interfaces.facilities import Scene

BALLS = np.array([[3.0, 2.0, 0.5], [5.0, -1.0, 0.5], [2.5, -4.0, 0.5], [5.5, 4.5, 0.5]])
RADIUS = 0.5


class Yard(Scene):
    """Level ground with balls on it, cast analytically."""

    def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
        down = directions_world[:, 2] < 0
        ranges = np.full(len(origins_world), np.inf)
        ranges[down] = -origins_world[down, 2] / directions_world[down, 2]
        for ball in BALLS:
            offset = origins_world - ball
            b = (offset * directions_world).sum(axis=1)
            inside = b**2 - (offset**2).sum(axis=1) + RADIUS**2
            hit = inside > 0
            ranges[hit] = np.minimum(ranges[hit], -b[hit] - np.sqrt(inside[hit]))
        return ranges


class Nothing(Yard):
    """Air."""

    def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
        return np.full(len(origins_world), np.inf)


class Blind:
    """A robot without a scene."""


PERFECT = {"depth_noise_m": 0, "point_noise_m": 0, "warp_m": 0, "scale_error": 0}


def drone(robot: object, **reconstruction: float) -> SimulatedDrone:
    return SimulatedDrone(
        SimulatedDroneSettings.model_validate({"reconstruction": reconstruction}), robot
    )  # type: ignore[arg-type]


def surface_distance(points: Float) -> Float:
    to_balls = np.linalg.norm(points[:, None] - BALLS, axis=2) - RADIUS
    return np.minimum(np.abs(to_balls).min(axis=1), np.abs(points[:, 2]))


def test_without_errors_every_point_lies_on_the_site_in_a_rigidly_moved_frame() -> None:
    plain = drone(Yard(), **PERFECT, tilt_rad=0, offset_m=0)
    points = plain._seen(np.random.default_rng(0))
    assert surface_distance(points).max() < 1e-9
    assert 40_000 < len(plain.survey(np.random.default_rng(0))) < 200_000


def test_sees_the_sides_of_stones_but_nothing_under_them() -> None:
    points = drone(Yard(), **PERFECT)._seen(np.random.default_rng(0))
    for ball in BALLS:
        near = points[np.linalg.norm(points - ball, axis=1) < RADIUS + 0.01]
        azimuths = np.degrees(np.arctan2(*(near - ball)[:, 1::-1].T)) // 30
        assert len(set(azimuths[near[:, 2] < 0.6])) == 12  # from all around
        under = points[np.linalg.norm(points[:, :2] - ball[:2], axis=1) < 0.05]
        assert (under[:, 2] > 0.9).all()  # only the top


def test_low_pictures_see_the_feet_of_stones() -> None:
    low, none = (
        SimulatedDrone(
            SimulatedDroneSettings.model_validate(
                {"reconstruction": PERFECT, "flight": {"low_cameras": cameras}}
            ),
            Yard(),  # type: ignore[arg-type]
        )._seen(np.random.default_rng(0))
        for cameras in (12, 0)
    )
    for ball in BALLS:
        feet = []
        for points in (low, none):
            near = points[np.linalg.norm(points - ball, axis=1) < RADIUS + 0.01]
            feet.append(int((near[:, 2] < 0.15).sum()))
        assert feet[0] > feet[1] + 20  # below the bulge


def test_the_low_ring_flies_above_what_stands_in_its_way() -> None:
    seen = drone(Yard())
    assert seen._top(BALLS[0][:2]) == pytest.approx(1.0)
    assert seen._top(np.array([20.0, 20.0])) == pytest.approx(0.0)
    assert SimulatedDrone(SimulatedDroneSettings(), Nothing())._top(np.zeros(2)) == 0.0


def test_noise_and_warp_have_the_size_that_the_settings_say() -> None:
    settings = ReconstructionSettings(warp_m=0.03)
    points = np.random.default_rng(0).uniform(-8, 8, (5000, 3))
    shift = warp(points, settings, np.random.default_rng(1)) - points
    assert np.abs(shift).max() <= 0.03
    assert np.abs(shift).max() > 0.01
    # Smooth: neighbours 0.1 m apart move together within slope · distance = 0.03 · 2π/10 · √3 · 0.1
    # m.
    step = points + np.array([0.1, 0, 0])
    beside = warp(step, settings, np.random.default_rng(1)) - step
    assert np.abs(beside - shift).max() < 0.0035

    noisy = drone(Yard(), warp_m=0)._seen(np.random.default_rng(0))
    ground = noisy[np.linalg.norm(noisy[:, None, :2] - BALLS[:, :2], axis=2).min(axis=1) > 1.5]
    # Depth noise of 12 mm, seen under 30–90° from the ground.
    assert 0.006 < ground[:, 2].std() < 0.012


def test_the_survey_is_the_site_up_to_a_similarity_within_its_settings() -> None:
    points = np.random.default_rng(0).uniform(-8, 8, (300, 3))
    scales, tilts, yaws = [], [], []
    for seed in range(40):
        framed = own_frame(points, ReconstructionSettings(), np.random.default_rng(seed))
        scale, R, t = similarity_fit(framed, points)
        assert np.allclose(scale * points @ R.T + t, framed)
        scales.append(scale)
        tilts.append(np.arccos(R[2, 2]))
        yaws.append(np.arctan2(R[1, 0], R[0, 0]))
    assert 0.99 <= min(scales) < 0.995
    assert 1.005 < max(scales) <= 1.01
    assert 0.04 < max(tilts) <= 0.0701
    assert len(set(np.round(np.degrees(yaws) // 90))) == 4


def test_a_survey_with_all_its_errors_stays_within_centimetres_of_the_site() -> None:
    survey = drone(Yard()).survey(np.random.default_rng(5))
    assert survey.frame == "survey"
    site = voxel_means(drone(Yard(), **PERFECT)._seen(np.random.default_rng(5)), 0.03)
    # The same flight in the same order of chance gives the true similarity through the drawn frame.
    rng = np.random.default_rng(5)
    flight = drone(Yard())
    seen = flight._seen(rng)
    rng.normal(0.0, 1.0, seen.shape)
    warp(seen, ReconstructionSettings(), rng)
    frame = own_frame(seen, ReconstructionSettings(), rng)
    scale, R, t = similarity_fit(frame, seen)
    back = (survey.points - t) @ R / scale
    distance, _ = cKDTree(site).query(back)
    assert np.sqrt((surface_distance(back) ** 2).mean()) < 0.03  # noise and warp
    assert np.percentile(distance, 95) < 0.08


def test_one_seed_gives_one_survey() -> None:
    a, b, c = (drone(Yard()).survey(np.random.default_rng(seed)).points for seed in (3, 3, 4))
    assert np.array_equal(a, b)
    assert a.shape != c.shape or not np.allclose(a, c)


def test_refuses_a_robot_without_a_scene() -> None:
    """At the survey and not at the start: a mission that surveys nothing runs without a scene."""
    blind = drone(Blind())
    blind.start()
    with pytest.raises(DataError, match="the robot Blind has none; use point_cloud_file"):
        blind.survey(np.random.default_rng(0))


def test_says_when_there_is_no_ground_below() -> None:
    settings = SimulatedDroneSettings.model_validate(
        {"flight": {"centre_m": (4, 0), "height_m": 8}}
    )

    class Void(Scene):
        def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
            return np.full(len(origins_world), np.inf)

    with pytest.raises(DataError, match=r"no ground: set surveying\.flight"):
        SimulatedDrone(settings, Void()).survey(np.random.default_rng(0))  # type: ignore[arg-type]
