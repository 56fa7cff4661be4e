"""More turns are tried before a structure is said to be full."""

from typing import ClassVar

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.footing import Footing, Noise
from executive_plugins.placing.dry_stone.height_maps import HeightMaps
from executive_plugins.placing.dry_stone.parts import Place, Stability
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.settings import (
    CheckSettings,
    DryStoneSettings,
    GeneratorSettings,
)

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


@pytest.mark.parametrize("supported", [True, False])
def test_a_stone_that_first_touches_beside_its_centre_fits_where_it_tilts_to_rest(
    supported: bool,
) -> None:
    """A beam over a low box and a high one touches the high one, which is not below its centre."""
    low = StandingStone(box("low", 0.4, 0.7, 0.2), pose(t=np.array([-0.6, 0.0, 0.1])))
    high = StandingStone(box("high", 0.4, 0.7, 0.4), pose(t=np.array([0.6, 0.0, 0.2])))
    built, beam = bare().with_standing(low, high), box("beam", 1.5, 0.5, 0.2)
    settings = GeneratorSettings(sides=1, turns=1, supported=supported)
    (places,) = HeightMaps(settings).places(built, [beam], np.random.default_rng(0), lambda: True)
    (one,) = places
    over_both = np.abs(one.origins_map - (0.0, 0.0, 0.5)).max(axis=1) < 0.05
    assert over_both.any() == (not supported)
    if not supported:
        place = Place(beam, pose(one.R, one.origins_map[over_both][0]), 0.0, {})
        at_rest = HeightMaps(settings)
        assert at_rest.at_rest(place, built, [beam]) is not None


def test_a_place_in_two_turns_is_two_places() -> None:
    """A gap that takes a stone in all its turns, at about one point, has all of them checked."""
    planner = DryStone(
        DryStoneSettings.model_validate({
            "check": {"part": f"{__name__}:Counts"}, "covered": 1.0,
            "generator": {"attitude": "kept", "turns": 4, "finer": 1, "kept": 100},
        })
    )  # fmt: skip
    Counts.headings.clear()
    planner.propose(two_apart(0.9), (box("long", 0.7, 0.5, 0.4),), np.random.default_rng(0))
    assert len(set(np.round(Counts.headings, 3))) == 4


class Counts:
    """A check that holds nothing, and notes how the stones were turned."""

    headings: ClassVar[list[float]] = []

    def __init__(self, settings: CheckSettings) -> None:
        del settings

    def check(self, place, built, rng, may_go_on):
        R = place.T_map_stone[:3, :3]
        self.headings.append(float(np.arctan2(R[1, 0], R[0, 0])))
        return Stability("topples", place.T_map_stone, 0.0, 0.0, {})


class Tilted(HeightMaps):
    """Tells that every stone rests at a tilt."""

    deg: ClassVar[float] = 0.0

    def footing(self, place: Place, built: AsBuilt, noise: Noise, most_rad: float) -> Footing:
        return Footing(float(np.radians(self.deg)), 0.0)


@pytest.mark.parametrize(
    ("deg", "finer", "fits"), [(6, 1, True), (8, 1, False), (8, 2, True), (10, 2, False)]
)
def test_a_tilt_that_a_map_may_have_mistaken_is_checked_before_nothing_is_said_to_fit(
    deg: float, finer: int, fits: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A rim of half a metre that is half a cell of 5 cm off in height is a tilt of 3°."""
    monkeypatch.setattr(Tilted, "deg", deg)
    planner = DryStone(
        DryStoneSettings.model_validate({
            "check": {"part": "none", "most_tilt": "6 deg"}, "covered": 1.0,
            "generator": {"part": f"{__name__}:Tilted", "attitude": "kept", "finer": finer},
        })
    )  # fmt: skip
    plan = planner.propose(bare(), (box("one", 0.7, 0.5, 0.4),), np.random.default_rng(0))
    assert plan.reason == (None if fits else "nothing_fits")
    assert fits or set(plan.refused) == {"tilts_away"}
