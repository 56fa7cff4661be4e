"""Rows of places on an arc: even around a full ring, and shifted to where most are usable."""

import numpy as np
import pytest
from executive_plugins.placing.spaced_row import spaced_row
from scipy.spatial import cKDTree

from executive.arrays import Float


def everywhere(xy: Float) -> float:
    return 0.0


def test_a_full_ring_closes_with_the_same_gap() -> None:
    row = spaced_row(6.0, 1.9, 2 * np.pi, np.eye(4), everywhere)
    assert len(row) == int(2 * np.pi / (2 * np.arcsin(1.9 / 12.0)))
    both = cKDTree(row).query(row, k=3)[0][:, 1:]
    np.testing.assert_allclose(both, both[0, 0], atol=1e-6)
    assert both.min() >= 1.9


def test_a_row_is_shifted_along_its_arc_to_where_most_places_are_usable() -> None:
    def in_gaps(xy: Float) -> float | None:
        """Allow places only within 0.04 rad of three azimuths that are one step apart."""
        azimuth = np.arctan2(xy[1], xy[0])
        return 0.0 if np.abs(azimuth - np.array([-0.4, -0.1, 0.2])).min() < 0.04 else None

    row = spaced_row(6.0, 12.0 * np.sin(0.15), 1.4, np.eye(4), in_gaps)
    assert len(row) == 3
    azimuths = np.sort(np.arctan2(row[:, 1], row[:, 0]))
    np.testing.assert_allclose(azimuths, [-0.4, -0.1, 0.2], atol=0.04)


@pytest.mark.parametrize("spacing_m", [20.0, 12.0])
def test_a_spacing_wider_than_the_ring_gives_at_most_two_places(spacing_m: float) -> None:
    assert 1 <= len(spaced_row(6.0, spacing_m, 2 * np.pi, np.eye(4), everywhere)) <= 2
