"""Where the drone takes its pictures, and what they look at."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.surveying.flight import Picture, take_pictures
from executive_plugins.surveying.settings import FlightSettings

from executive.arrays import Float

SETTINGS = FlightSettings(cameras=20, low_cameras=12, low_height_m=2.5)


def level(place: Float) -> float:
    return 0.0


def hill(place: Float) -> float:
    return 0.2 * float(place[0])


def pictures(seed: int, top: Callable[[Float], float] = level) -> list[Picture]:
    return take_pictures(SETTINGS, top, np.random.default_rng(seed))


def turns(positions: Float) -> Float:
    """Return how far around its ellipse each position is, as a share of a whole turn."""
    offsets = (positions[:, :2] - SETTINGS.centre_m) / SETTINGS.size_m
    return np.asarray(np.arctan2(offsets[:, 1], offsets[:, 0]) / (2 * np.pi))


@pytest.mark.parametrize("seed", range(4))
def test_pictures_are_spread_all_around_all_rings_but_not_evenly(seed: int) -> None:
    positions = np.array([p.position for p in pictures(seed)])
    for ring, radius in ((positions[:15], 0.65), (positions[15:20], 0.3), (positions[20:], 0.65)):
        offsets = (ring[:, :2] - SETTINGS.centre_m) / SETTINGS.size_m
        np.testing.assert_allclose(np.linalg.norm(offsets, axis=1), radius)
        share = turns(ring) - np.arange(len(ring)) / len(ring)
        off = (share + 0.5) % 1 - 0.5
        assert np.abs(off).max() <= 0.3 / len(ring) + 1e-9
        assert np.abs(off).max() > 0.1 / len(ring)  # a pilot is not exact
    assert np.abs(positions[:20, 2] / SETTINGS.height_m - 1).max() <= 0.1
    assert np.abs(positions[20:, 2] / SETTINGS.low_height_m - 1).max() <= 0.1


def test_the_low_ring_keeps_its_height_above_the_ground_of_a_slope() -> None:
    positions = np.array([p.position for p in pictures(0, hill)])[20:]
    above = positions[:, 2] - [hill(place) for place in positions]
    assert np.abs(above / SETTINGS.low_height_m - 1).max() <= 0.1
    assert np.ptp(positions[:, 2]) > 1.0


def test_another_flight_takes_its_pictures_elsewhere() -> None:
    a, b = (pictures(seed) for seed in (1, 2))
    assert all(np.abs(p.position - q.position).max() > 0.01 for p, q in zip(a, b, strict=True))


def test_each_picture_looks_at_the_ground_on_its_own_side() -> None:
    for picture in pictures(0)[:15]:
        forward = picture.rays.mean(axis=0)
        aim = picture.position - picture.position[2] / forward[2] * forward
        at_camera, at_aim = (x[:2] - SETTINGS.centre_m for x in (picture.position, aim))
        assert 0.2 < at_camera @ at_aim / (at_camera @ at_camera) < 0.9
        np.testing.assert_allclose(np.linalg.norm(picture.rays, axis=1), 1.0)
