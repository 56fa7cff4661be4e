"""More turns are tried before a structure is said to be full."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.settings import DryStoneSettings

from executive.geometry.pose import pose
from executive.messages.building import AsBuilt, StandingStone
from executive.testing.exercises.building import bare, box


def two_apart(gap_m: float) -> AsBuilt:
    """Return a wall with two high boxes and a gap between them, up to its height elsewhere."""
    side_m = (3.0 - gap_m) / 2
    return bare().with_standing(*(
        StandingStone(box(f"side_{k}", side_m, 0.78, 0.9), pose(t=np.array([x_m, 0.0, 0.45])))
        for k, x_m in enumerate((-(gap_m + side_m) / 2, (gap_m + side_m) / 2))
    ))  # fmt: skip


@pytest.mark.parametrize(
    ("finer", "gap_m", "fits"), [(1, 0.7, False), (2, 0.7, True), (2, 0.4, False)]
)
def test_a_stone_that_only_fits_across_the_wall_is_laid_across(
    finer: int, gap_m: float, fits: bool
) -> None:
    """Two turns lay it along the wall, where the gap is too narrow; four lay it across, too."""
    generator = {
        "attitude": "kept", "turns": 2, "finer": finer, "cell": 0.05, "stride": 1, "over_top": 0.0
    }  # fmt: skip
    one = DryStone(
        DryStoneSettings.model_validate({
            "check": {"part": "none"}, "generator": generator, "covered": 1.0,
        })
    )  # fmt: skip
    plan = one.propose(two_apart(gap_m), (box("long", 0.78, 0.4, 0.4),), np.random.default_rng(0))
    assert plan.reason == (None if fits else "nothing_fits")
    if fits:
        R = plan.targets[0].T_map_settled[:3, :3]
        assert abs(R[1, 0]) == pytest.approx(1.0)  # its longer side is across
