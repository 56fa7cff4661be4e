"""The dry-stone planner on stones whose right place is known."""

import time
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.physics.equilibrium import Touch, largest_load
from executive_plugins.physics.trial import apart
from executive_plugins.placing.dry_stone.drops import HEIGHT, OUTSIDE, SHARE, DropRules, drops
from executive_plugins.placing.dry_stone.height_maps import HeightMaps
from executive_plugins.placing.dry_stone.parts import Places, Stability, part_of
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_of
from executive_plugins.placing.dry_stone.settings import DryStoneSettings, ScorerSettings
from executive_plugins.placing.trial_site import RigidStones

from executive.errors import ConfigError, DataError
from executive.geometry.pose import pose
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure
from executive.testing.exercises.building import bare, box, boxes, first_course

GENERATOR = {"sides": 2, "turns": 2, "cell": 0.1, "finer": 1}
UNCHECKED = {"check": {"part": "none"}, "generator": GENERATOR}
RULES = DropRules(0.03, 0.0, 0.0, 1)


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def planner(**settings: object) -> DryStone:
    return DryStone(DryStoneSettings.model_validate({**UNCHECKED, **settings}))


class Highest:
    """A scorer of somebody else's: the higher, the better."""

    def __init__(self, settings: ScorerSettings) -> None:
        del settings

    def score(self, places, built, inventory):
        return {"mine": places.origins_map[:, 2]}


class WestFirst:
    """A scorer that ranks places from west to east."""

    def score(self, places, built, inventory):
        return {"west": -places.origins_map[:, 0]}


def test_a_box_over_two_boxes_rests_on_both() -> None:
    stone = box("top", 0.9, 0.6, 0.3)
    raster = raster_of(stone.vertices, stone.triangles, np.eye(3), 0.05)
    wall = WallTop(first_course(), 0.05)
    nodes, found = drops(wall, raster, RULES)
    middle = np.argmin(np.abs((nodes + wall.corner) * 0.05 - (0.5, 0.0)).sum(axis=1))
    assert found[middle, HEIGHT] == pytest.approx(0.4 + 0.15, abs=1e-6)
    assert found[middle, SHARE] < 0.6  # neither of the two bears it alone


def test_places_that_fit_are_measured_alike_when_the_others_are_left_out() -> None:
    stone = box("top", 0.9, 0.6, 0.3)
    raster = raster_of(stone.vertices, stone.triangles, np.eye(3), 0.05)
    wall = WallTop(first_course(), 0.05)
    for lean in (0.0, 0.2):
        all_of, few = (
            drops(wall, raster, DropRules(0.03, lean, lean, 1, most))[1] for most in (1.0, 0.12)
        )
        fits = all_of[:, OUTSIDE] <= 0.12
        assert 0 < fits.sum() < len(fits)
        np.testing.assert_array_equal(few[:, OUTSIDE] <= 0.12, fits)
        np.testing.assert_array_equal(few[fits], all_of[fits])


def test_a_kept_attitude_is_turned_about_the_vertical_alone() -> None:
    plan = planner(generator={**UNCHECKED["generator"], "attitude": "kept", "turns": 3}).propose(
        bare(), (box("upright", 0.3, 0.3, 0.6),), rng()
    )
    R = plan.targets[0].T_map_settled[:3, :3]
    np.testing.assert_allclose(R[2], [0.0, 0.0, 1.0], atol=1e-9)


@pytest.mark.parametrize(("height_m", "reason"), [(0.5, "complete"), (0.9, None)])
def test_a_structure_that_is_up_to_its_height_is_complete(
    height_m: float, reason: str | None
) -> None:
    course = first_course()  # 0.4 m high, on all of the length
    wall = Structure("wall", course.structure.line, 0.8, height_m)
    plan = planner().propose(AsBuilt(wall, course.ground, course.standing), boxes(), rng())
    assert plan.reason == reason
    assert bool(plan.targets) == (reason is None)


@pytest.mark.parametrize(
    ("thick_m", "over_top", "fits"),
    [(0.38, None, True), (0.48, None, False), (0.38, 0.1, False), (0.48, 0.3, True)],
)
def test_a_stone_may_stand_above_the_top_by_half_of_its_thickness(
    thick_m: float, over_top: float | None, fits: bool
) -> None:
    """The structure stands 0.7 m high, and 0.9 m are wanted: 0.38 m more end 0.18 m above it."""
    stands = [
        StandingStone(box(f"foot_{k}", 0.96, 0.7, 0.7), pose(t=np.array([0.98 * (k - 1), 0, 0.35])))
        for k in range(3)
    ]
    generator = {**UNCHECKED["generator"], "attitude": "kept", "over_top": over_top}
    stone = box("next", 0.9, 0.6, thick_m)
    plan = planner(generator=generator).propose(bare().with_standing(*stands), (stone,), rng())
    assert (plan.reason is None) == fits
    assert plan.refused == ({} if fits else {"no_place": 1})
    assert plan.by_stone == ({} if fits else {"next": {"no_place": 1}})


def test_no_place_is_checked_twice_though_stones_are_gone_through_twice(monkeypatch) -> None:
    """No place holds, so that all are measured once more with more turns, each checked once."""
    generator = {**GENERATOR, "finer": 2}
    one, asked = planner(check={"part": "none", "tries": 9}, generator=generator), []
    of_all = HeightMaps.places

    def places(self, built, stones, *rest):
        asked.append((self._settings.turns, len(stones)))
        return of_all(self, built, stones, *rest)

    monkeypatch.setattr(HeightMaps, "places", places)
    checked: list[tuple[str, bytes]] = []

    def refuse(place, built, rng, may_go_on):
        checked.append((place.stone.name, place.T_map_stone.tobytes()))
        return Stability("slides_away", place.T_map_stone, 0.0, 0.0, {})

    monkeypatch.setattr(one._check, "check", refuse)
    plan = one.propose(bare(), boxes(), rng())
    assert plan.reason == "nothing_fits"
    assert asked == [(2, len(boxes())), (4, len(boxes()))]
    assert len(set(checked)) == len(checked) == plan.refused["slides_away"] > 9
    of_each = Counter(stone for stone, _ in checked)
    assert plan.by_stone == {stone: {"slides_away": n} for stone, n in of_each.items()}
    assert next(iter(plan.by_stone)) == checked[0][0]  # the reason of the best place comes first


@pytest.mark.parametrize("is_empty", [True, False])
def test_a_generator_of_others_may_yield_nothing_or_single_precision(monkeypatch, is_empty) -> None:
    one = planner()
    T = np.array([[0.0, 0.0, 0.4]], dtype=np.float32)
    yielded = [] if is_empty else [Places(boxes()[0], np.eye(3), T, {})]
    monkeypatch.setattr(one._generator, "places", lambda *given: iter([yielded]))
    one._scorer = WestFirst()
    plan = one.propose(bare(), boxes()[:1], rng())
    assert plan.reason == ("nothing_fits" if is_empty else None)


def test_heights_follow_a_slope_of_five_degrees() -> None:
    slope = np.radians(5.0)
    ground = HeightGrid.plane(np.array([-4.0, -4.0]), np.array([4.0, 4.0]), slope)
    built = AsBuilt(bare().structure, ground)
    plan = planner().propose(built, boxes()[:1], rng())
    at = plan.targets[0].T_map_settled[:3, 3]
    above = at[2] - np.tan(slope) * at[0]
    assert 0.15 < above < 0.45  # half of a side of 0.7, 0.6 or 0.35 m, and the rise below it


def test_a_stone_on_a_slope_of_five_degrees_holds_by_every_check() -> None:
    slope = np.radians(5.0)
    ground = HeightGrid.plane(np.array([-4.0, -4.0]), np.array([4.0, 4.0]), slope)
    built = AsBuilt(bare().structure, ground)
    settings = {"check": {"pieces": 1, "samples": 3}, "generator": {"cell": 0.1, "sides": 1}}
    checked = DryStone(DryStoneSettings.model_validate(settings))
    target = checked.propose(built, boxes()[:1], rng()).targets[0]
    assert 0.0 < target.worst_m < 0.1
    up = target.T_map_settled[:3, :3].T @ [-np.sin(slope), 0.0, np.cos(slope)]
    assert np.abs(up).max() > 0.999  # a side of the box lies on the slope, within 2.6°


def test_a_scorer_from_outside_changes_the_choice() -> None:
    mine = f"{__name__}:Highest"
    with pytest.raises(ConfigError, match="cannot be used"):
        planner(scorer={"part": "no_such_package:Highest"})
    scorer = part_of("highest", "scorer", {"highest": Highest}, ScorerSettings())
    chosen = planner()
    chosen._scorer = scorer
    standing = planner().propose(bare(), boxes(), rng()).targets[0]
    highest = chosen.propose(bare(), boxes(), rng()).targets[0]
    assert highest.terms.keys() == {"mine"}, mine
    assert highest.T_map_settled[2, 3] > standing.T_map_settled[2, 3]


@pytest.mark.parametrize(
    ("stones", "settings", "reason"),
    [
        ((), {}, "no_stones"),
        (boxes(), {"max_mass": 10.0}, "all_too_heavy"),
        ((box("needle", 2.0, 0.3, 0.3),), {}, "all_unsuitable"),
        ((box("slab", 1.2, 1.2, 0.1),), {}, "all_unsuitable"),
        ((box("huge", 1.4, 1.4, 1.4),), {"max_mass": 9e3}, "nothing_fits"),
    ],
)
def test_what_cannot_be_used_is_refused_with_its_reason(stones, settings, reason) -> None:
    plan = planner(**settings).propose(bare(), stones, rng())
    assert (plan.targets, plan.reason) == ((), reason)


def test_a_stone_that_jaws_hold_is_placed_however_heavy_it_has_turned_out() -> None:
    (stone,) = boxes()[:1]
    held = replace(stone, jaws=(np.array([[0.0, 0.0, 5.0]]),))
    chosen = planner(max_mass=10.0)
    assert chosen.propose(bare(), [stone], rng()).reason == "all_too_heavy"
    assert chosen.propose(bare(), [held], rng()).reason is None


def test_a_flat_natural_stone_is_used() -> None:
    """It is as slender as the flattest of 100 scans with room at its sides, and lies well."""
    plan = planner().propose(bare(), (box("flat", 1.2, 0.9, 0.25),), rng())
    assert [target.stone for target in plan.targets] == ["flat"]
    assert planner(slenderest=3.5).propose(
        bare(), (box("flat", 1.2, 0.9, 0.25),), rng()
    ).reason == ("all_unsuitable")


class OnlyAtTheEnd:
    """A check that refuses every place but those at one end of the wall, and notes what it saw."""

    def __init__(self) -> None:
        self.seen: list[bytes] = []

    def check(self, place, built, rng, may_go_on):
        self.seen.append(place.T_map_stone.tobytes())
        holds = place.T_map_stone[0, 3] > 0.9
        return Stability("" if holds else "slides_away", place.T_map_stone, 0.0, 0.0, {})


def test_more_places_are_tried_before_nothing_fits() -> None:
    """The best five of the one stone that is left all slide; one that is ranked lower holds."""
    built = first_course()
    (stone,) = boxes()[:1]
    chosen = planner()
    chosen._scorer, chosen._check = WestFirst(), (check := OnlyAtTheEnd())
    plan = chosen.propose(built, (stone,), rng())
    assert plan.reason is None
    assert plan.targets[0].T_map_settled[0, 3] > 0.9
    assert plan.refused == {"slides_away": len(check.seen) - 1}
    assert len(check.seen) == len(set(check.seen)) > 5  # none of them twice


def test_no_time_is_told() -> None:
    assert planner().propose(bare(), boxes(), rng(), lambda: False).reason == "out_of_time"


@pytest.mark.parametrize(("budget_s", "reason"), [(1e-6, "out_of_time"), (600.0, None)])
def test_a_search_ends_with_its_own_budget(budget_s: float, reason: str | None) -> None:
    assert planner(budget=budget_s).propose(bare(), boxes(), rng()).reason == reason


def test_two_stones_of_one_name_are_refused() -> None:
    with pytest.raises(DataError, match="two stones"):
        planner().propose(bare(), (boxes()[0], boxes()[0]), rng())


def test_the_plan_follows_the_structure_as_built() -> None:
    planned = planner().propose(bare(), boxes()[:1], rng()).targets[0].T_map_settled
    again = planner().propose(first_course(), boxes()[:1], rng()).targets[0].T_map_settled
    assert again[2, 3] > planned[2, 3] + 0.35


def test_a_block_on_a_plane_bears_its_friction_or_its_width() -> None:
    corners = [(x, y, 0.0) for x in (-0.2, 0.2) for y in (-0.5, 0.5)]
    touches = [Touch(-1, 0, np.array(c), np.array([0.0, 0.0, 1.0])) for c in corners]
    for height, wanted in ((0.1, 0.5), (1.0, 0.2)):  # it slides; it topples at width over height
        centre = np.array([[0.0, 0.0, height]])
        load = largest_load(touches, centre, np.array([900.0]), 0.5, np.array([1.0, 0.0, 0.0]))
        assert load == pytest.approx(wanted, abs=1e-6)


def test_forces_that_cannot_balance_are_none() -> None:
    one = [Touch(-1, 0, np.array([0.3, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))]
    centre, mass = np.array([[0.0, 0.0, 0.5]]), np.array([900.0])
    assert largest_load(one, centre, mass, 0.5, np.array([1.0, 0.0, 0.0])) is None


@pytest.mark.parametrize(
    ("line", "volume"),
    [
        ([[0.0, 0.0]], np.pi * 0.25),
        ([[0.0, 0.0], [2.0, 0.0]], 2.0),
        ([[0, 0], [1, 0], [1, 1]], 2.0),
    ],
)
def test_the_volume_of_an_envelope(line, volume) -> None:
    structure = Structure("one", np.array(line, dtype=float), 1.0, 1.0)
    assert structure.volume_m3() == pytest.approx(volume)


def test_a_ring_has_no_ends() -> None:
    angles = np.linspace(0, 2 * np.pi, 25)
    ring = Structure("ring", 2 * np.column_stack([np.cos(angles), np.sin(angles)]), 1.0, 1.0)
    depth = ring.depth_m(np.array([[2.0, 0.0], [0.0, -2.0], [0.0, 0.0]]), np.zeros(3))
    assert (depth[:2] > 0.4).all()
    assert depth[2] < 0


def test_a_curved_wall_keeps_its_stones_on_the_curve() -> None:
    angles = np.linspace(0.0, np.pi / 2, 12)
    arc = 3.0 * np.column_stack([np.cos(angles), np.sin(angles)])
    built = AsBuilt(Structure("bend", arc, 1.0, 0.6), bare().ground)
    settings = {"generator": {"attitude": "kept", "turns": 8, "cell": 0.1, "most_outside": 0.0}}
    for stone in boxes():
        target = planner(**settings).propose(built, (stone,), rng()).targets[0]
        built = built.with_standing(*built.standing, StandingStone(stone, target.T_map_settled))
    for one in built.standing:
        assert (built.structure.depth_m(one.vertices_map()[:, :2], np.zeros(8)) > -0.1).all()
    headings = [np.arctan2(*one.T_map_stone[1::-1, 3]) for one in built.standing]
    assert np.ptp(headings) > 0.3  # side by side along the arc


def test_half_a_second_gives_a_held_target_or_says_that_time_was_over() -> None:
    checked = DryStone(DryStoneSettings.model_validate({"check": {"pieces": 1}}))
    begun = time.process_time()
    end = begun + 0.5
    plan = checked.propose(first_course(), boxes(), rng(), lambda: time.process_time() < end)
    # A compiled kernel is loaded, and the one trial that is under way is not cut short.
    assert time.process_time() - begun < 5.0
    assert bool(plan.targets) != (plan.reason == "out_of_time")


@pytest.mark.parametrize(
    ("heavier", "aside_m", "is_right"), [(1.3, 0.08, True), (1.0, 0.40, False)]
)
def test_a_stone_whose_mass_and_centre_lie_shows_it_when_it_settles(
    heavier: float, aside_m: float, is_right: bool
) -> None:
    """The plan takes the middle for the centre of mass; the stone that is set down has another."""
    believed = box("top", 0.9, 0.6, 0.3)
    T = pose(t=np.array([0.2, 0.0, 0.55]))  # on a box that reaches to 0.48 m
    off = np.array([aside_m, 0.0, 0.0])
    true = SolidStone("top", believed.vertices - off, believed.triangles,
                      heavier * believed.mass_kg)  # fmt: skip
    alone = first_course().with_standing(first_course().standing[1])
    settled = RigidStones().place(alone, true, T @ pose(t=off), (0.0, 0.0), rng()).poses[-1]
    far_m, far_rad = apart(T, settled @ pose(t=-off))
    assert (far_m < 0.10 and far_rad < np.radians(10.0)) == is_right


@pytest.mark.parametrize(("refusal", "most"), [("slides_away", 2), ("tilts", 18)])
def test_a_stone_that_tilts_costs_one_release_of_a_check(
    monkeypatch: pytest.MonkeyPatch, refusal: str, most: int
) -> None:
    """Two checks are two times a release and eight under noise; one round of places is tried."""
    check = {"part": "none", "tries": 2, "samples": 8}
    one, seen = planner(check=check, generator={"finer": 1}), []

    def refuse(place, built, rng, may_go_on):
        seen.append(place)
        return Stability(refusal, place.T_map_stone, 0.0, 0.0, {})

    monkeypatch.setattr(one._check, "check", refuse)
    assert one.propose(bare(), boxes(), rng()).refused[refusal] == len(seen) == most
