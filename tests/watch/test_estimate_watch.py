"""The estimate may be used up to each of its limits, and not beyond."""

import numpy as np
import pytest

from executive.messages.base_state import BaseState
from executive.watch.estimate_watch import estimate_trouble, stale
from executive.watch.rules import EstimateRule

RULE = EstimateRule(do="tell", position_std=0.5, heading_std=0.25)


def state(heading: float = 0.1, position: float = 0.1, status: str = "GLOBAL") -> BaseState:
    covariance = np.diag([0.01, heading, 0.01, 0.01, 0.01, position]) ** 2
    still = {"v_map_cabin": np.zeros(3), "w_map_cabin_in_cabin": np.zeros(3)}
    poses = dict.fromkeys(("T_odom_base", "T_map_base", "T_map_cabin"), np.eye(4))
    return BaseState(stamp_s=10.0, covariance=covariance, status=status, **poses, **still)


@pytest.mark.parametrize(
    ("one", "now_s", "told"),
    [
        (state(), 10.0, ""),
        (state(), 10.5, ""),
        (state(), 10.51, "the estimate is 0.51 s old"),
        (state(position=0.5, heading=0.25), 10.0, ""),
        (state(position=0.51), 10.0, "the position is uncertain by 0.51 m"),
        (state(heading=0.251), 10.0, "the rotation is uncertain by 0.251 rad"),
        (state(position=0.51, heading=0.3), 10.0, "the position is uncertain by 0.51 m"),
        (state(status="LOST"), 99.0, "the estimate is LOST"),
    ],
)
def test_an_estimate_is_refused_beyond_a_limit(one: BaseState, now_s: float, told: str) -> None:
    assert estimate_trouble(one, now_s, 0.5, RULE) == told


def test_age_counts_beyond_a_microsecond() -> None:
    assert stale(state(), 10.5 + 9e-7, 0.5) == ""
    assert stale(state(), 10.5 + 2e-6, 0.5)
