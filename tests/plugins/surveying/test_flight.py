"""Where the drone takes its pictures, and what they look at."""

import numpy as np
import pytest
from executive_plugins.surveying.flight import take_pictures
from executive_plugins.surveying.settings import FlightSettings

from executive.arrays import Float

SETTINGS = FlightSettings(cameras=20)


def turns(positions: Float) -> Float:
    """Return how far around its ellipse each position is, as a share of a whole turn."""
    offsets = (positions[:, :2] - SETTINGS.centre_m) / SETTINGS.size_m
    return np.asarray(np.arctan2(offsets[:, 1], offsets[:, 0]) / (2 * np.pi))


@pytest.mark.parametrize("seed", range(4))
def test_pictures_are_spread_all_around_both_rings_but_not_evenly(seed: int) -> None:
    positions = np.array([p.position for p in take_pictures(SETTINGS, np.random.default_rng(seed))])
    for ring, radius in ((positions[:15], 0.65), (positions[15:], 0.3)):
        offsets = (ring[:, :2] - SETTINGS.centre_m) / SETTINGS.size_m
        np.testing.assert_allclose(np.linalg.norm(offsets, axis=1), radius)
        share = turns(ring) - np.arange(len(ring)) / len(ring)
        off = (share + 0.5) % 1 - 0.5
        assert np.abs(off).max() <= 0.3 / len(ring) + 1e-9
        assert np.abs(off).max() > 0.1 / len(ring)  # a pilot is not exact
    assert np.abs(positions[:, 2] / SETTINGS.height_m - 1).max() <= 0.1


def test_another_flight_takes_its_pictures_elsewhere() -> None:
    a, b = (take_pictures(SETTINGS, np.random.default_rng(seed)) for seed in (1, 2))
    assert all(np.abs(p.position - q.position).max() > 0.01 for p, q in zip(a, b, strict=True))


def test_each_picture_looks_at_the_ground_on_its_own_side() -> None:
    for picture in take_pictures(SETTINGS, np.random.default_rng(0))[:15]:
        forward = picture.rays.mean(axis=0)
        aim = picture.position - picture.position[2] / forward[2] * forward
        at_camera, at_aim = (x[:2] - SETTINGS.centre_m for x in (picture.position, aim))
        assert 0.2 < at_camera @ at_aim / (at_camera @ at_camera) < 0.9
        np.testing.assert_allclose(np.linalg.norm(picture.rays, axis=1), 1.0)
