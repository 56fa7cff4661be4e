"""What drift of odometry is usual, by the record of the windows before."""

import pytest
from executive_plugins.estimation.gate.drift_record import DriftRecord

WINDOW_S = 10.0
UNKNOWN = 0.03  # three standard deviations of 1 %


def after(shares: list[float], way_m: float = 20.0) -> float:
    """Return what a record explains after windows one behind the other."""
    record = DriftRecord(WINDOW_S)
    for k, share in enumerate(shares):
        record.add(k * WINDOW_S, share * way_m, way_m)
    return record.share


def test_without_a_record_three_per_cent_are_usual() -> None:
    assert after([]) == pytest.approx(UNKNOWN)


def test_a_window_counts_only_once_the_next_one_has_passed() -> None:
    assert after([0.2]) == pytest.approx(UNKNOWN)
    assert after([0.2, 0.0]) > 2 * UNKNOWN


@pytest.mark.parametrize("share", [0.0, 0.05])
def test_a_drift_that_was_always_there_becomes_the_usual_one(share: float) -> None:
    # Ten windows of it stand beside three of 1 %.
    expected = 3 * ((10 * share**2 + 3 * 0.01**2) / 13) ** 0.5
    assert after([share] * 11) == pytest.approx(expected)
    assert after([0.4] + [share] * 11) == pytest.approx(expected)  # the oldest is forgotten


def test_a_short_way_tells_nothing() -> None:
    assert after([0.5] * 5, way_m=0.9) == pytest.approx(UNKNOWN)
    assert after([0.5] * 5, way_m=1.1) > 10 * UNKNOWN


def test_windows_that_overlap_count_once() -> None:
    record = DriftRecord(WINDOW_S)
    record.add(0.0, 0.0, 20.0)
    for stamp_s in (3.0, 6.0, 9.9):
        record.add(stamp_s, 10.0, 20.0)
    record.add(WINDOW_S, 0.0, 20.0)  # adjoins the first: it counts
    record.add(2 * WINDOW_S, 0.0, 20.0)
    assert record.share < UNKNOWN
