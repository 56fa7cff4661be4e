"""Where a cloud shows plain ground."""

import numpy as np
import pytest
from executive_plugins.registration.site_view import SiteView

from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation


def site(side_m: float, points: int) -> SiteView:
    """Return level ground about the origin with a stone in its middle."""
    rng = np.random.default_rng(0)
    xy = rng.uniform(-side_m / 2, side_m / 2, (points, 2))
    stone = rng.uniform([-0.4, -0.4, 0.1], [0.4, 0.4, 0.6], (500, 3))
    return SiteView(
        Segmentation(
            frame="map",
            segments=(Segment(0, stone, stone.mean(axis=0), np.array([0.8, 0.8, 0.5])),),
            ground=Cloud("map", np.column_stack([xy, np.zeros(points)])),
            ground_plane=np.array([0.0, 0.0, 1.0, 0.0]),
        ),
        0.08,
    )


def test_plain_ground_is_told_beside_a_stone_and_not_under_it_or_outside() -> None:
    view = site(20.0, 40_000)
    beside = np.array([[2.5, 0.0, 0.0], [0.0, -2.5, 0.3]])
    assert view.share_on_plain_ground(beside) == 1.0
    assert view.is_open(beside + [0.0, 0.0, 0.5], 0.1).all()
    for unseen in (np.zeros((1, 3)), np.array([[40.0, 0.0, 0.5]])):
        assert view.share_on_plain_ground(unseen) == 0.0
        assert not view.is_open(unseen, 0.1).any()


def test_a_wide_site_has_no_more_cells_than_one_of_250_m() -> None:
    low, is_plain, tops, cell_m = site(1000.0, 100_000)._plain
    assert is_plain.shape == tops.shape == pytest.approx((1000, 1000), abs=2)
    assert cell_m == pytest.approx(1.0, rel=0.01)
    assert low == pytest.approx([-500, -500], abs=2)
    assert site(20.0, 1000)._plain[3] == 0.25
