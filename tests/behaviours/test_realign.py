"""A relocated stone is aligned with the map; beyond the aligner's basin it is looked for anew; else
nothing changes.
"""

import numpy as np
import pytest
from executive_plugins.objects.sqlite import SqliteObjects

from executive.behaviours.find_again import FindAgain, FindAgainSettings
from executive.behaviours.relocate_and_realign import RelocateAndRealign, RelocateAndRealignSettings
from executive.geometry.pose import pose
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import Stone, StoneState
from executive.messages.weight import Weight

RNG = np.random.default_rng(0)
T_NEAR, T_FAR = pose(None, np.array([0.1, 0, 0])), pose(None, np.array([1.0, 0.5, 0]))


def stone(number, centre, state=StoneState.PLACED):
    points = RNG.uniform(-0.4, 0.4, (500, 3)) + centre
    return Stone(
        number, state, points, points.mean(axis=0), pose(None, np.array(centre, dtype=float)), True
    )


def answer(T, accepted, reason="as told"):
    return Alignment(T, accepted, reason, 0.02, 0.8)


NEAR = answer(T_NEAR, True)


class Objects(SqliteObjects):
    """Keeps stones as they are given; scene verbs are the real ones."""

    def __init__(self, *stones):
        super().__init__(SqliteObjects.Settings())
        self.known = {one.id: one for one in stones}
        self.moves = []
        self.seen = []

    def stone(self, number):
        return self.known[number]

    def stones(self):
        return tuple(self.known.values())

    def realign(self, number, T, stamp_s, note=""):
        self.moves.append((number, T, note))
        return self.known[number]

    def set_state(self, number, state, stamp_s):
        return self.known[number]

    def observe(self, segments, stamp_s, from_above):
        self.seen.append(segments)
        return tuple(self.known.values())


class Mapper:
    def __init__(self, points):
        self._points = points

    def cloud(self):
        return Cloud("map", self._points)


class Method:
    """An aligner and a registrar that answer as they are told, and note what they were asked."""

    def __init__(self, told):
        self._told = told
        self.asked = []

    def align(self, target, source, T_guess, reach_m):
        self.asked.append(target)
        return self._told

    def find(self, target, model):
        self.asked.append(target)
        return self._told

    def segment(self, cloud):
        part = Segment(0, cloud.points, cloud.points.mean(axis=0), np.ones(3))
        return Segmentation(
            "map", (part,), Cloud("map", np.empty((0, 3))), np.array([0, 0, 1.0, 0])
        )


def context_of(fakes, aligned, found, *others):
    own = stone(1, (5, 0, 0.4))
    shown = own.points_map + [0.1, 0, 0] if aligned is NEAR else found.apply(own.points_map)
    points = np.vstack([shown, *[other.points_map for other in others]])
    return fakes.Context(
        mapping=Mapper(points), alignment=Method(aligned), registration=Method(found),
        segmentation=Method(None),
        objects=Objects(own, *others),
    )  # fmt: skip


def test_what_the_aligner_accepts_is_done_and_nobody_else_asked(fakes):
    context = context_of(fakes, NEAR, answer(T_FAR, True))
    outcome = fakes.finish(RelocateAndRealign(RelocateAndRealignSettings(), context), stone=1)
    assert outcome.success
    assert [(number, note) for number, _, note in context.plugins["objects"].moves] == [
        (1, "alignment, as told")
    ]
    assert context.plugins["registration"].asked == []


@pytest.mark.parametrize("aligned", [answer(T_NEAR, False), answer(T_FAR, True)])
def test_a_stone_beyond_the_basin_is_looked_for_anew(fakes, aligned):
    """Refused, or accepted but too far to be a settling."""
    context = context_of(fakes, aligned, answer(T_FAR, True))
    fakes.finish(RelocateAndRealign(RelocateAndRealignSettings(), context), stone=1)
    ((number, T, note),) = context.plugins["objects"].moves
    assert (number, note) == (1, "registration, as told")
    np.testing.assert_array_equal(T, T_FAR)
    assert context.notes[-1][1]["method"] == "registration"


def test_what_both_refuse_changes_nothing_and_says_why(fakes):
    context = context_of(
        fakes, answer(T_NEAR, False, "no overlap"), answer(T_FAR, False, "too small")
    )
    outcome = fakes.finish(RelocateAndRealign(RelocateAndRealignSettings(), context), stone=1)
    assert not outcome.success
    assert context.plugins["objects"].moves == []
    assert "no overlap; registration: too small" in outcome.reason


def test_a_dropped_stone_keeps_its_model_where_it_is_found(fakes):
    context = context_of(fakes, answer(T_NEAR, False), answer(T_FAR, True))
    assert fakes.finish(FindAgain(FindAgainSettings(), context), stone=1).success
    ((number, T, _),) = context.plugins["objects"].moves
    assert number == 1
    np.testing.assert_array_equal(T, T_FAR)
    assert context.plugins["objects"].seen == []  # what it leans on is not taken for it


def test_a_dropped_stone_that_is_not_found_is_left_to_the_segmentation(fakes):
    context = context_of(fakes, answer(T_NEAR, False), answer(T_FAR, False))
    assert fakes.finish(FindAgain(FindAgainSettings(), context), stone=1).success
    assert context.plugins["objects"].moves == []
    assert len(context.plugins["objects"].seen) == 1


@pytest.mark.parametrize(("away_m", "known"), [(8.0, 3), (10.0, 2)])
def test_what_is_seen_beyond_the_reach_is_entered_by_no_search(
    fakes, stage, database, away_m, known
):
    """Its near side alone was entered from 9.9 m, and was another stone from near by."""
    stones = [database.stone(number).points_map for number in (1, 2)]
    other = stage.block((away_m, -1.0, 0.3), size=(0.4, 0.9, 0.6))
    context = fakes.Context(
        mapping=Mapper(np.vstack([*stones, other])),
        registration=Method(answer(T_FAR, False, "their forms differ")),
        segmentation=Method(None),
        objects=database,
    )
    parts = [
        Segment(i, one, one.mean(axis=0), np.ones(3)) for i, one in enumerate([*stones, other])
    ]
    context.plugins["segmentation"].segment = lambda cloud: Segmentation(
        "map", tuple(parts), Cloud("map", np.empty((0, 3))), np.array([0, 0, 1.0, 0])
    )
    assert fakes.finish(FindAgain(FindAgainSettings(), context), stone=1).success
    assert len(database.stones()) == known


@pytest.mark.parametrize(("away_m", "is_found"), [(1.2, True), (2.9, True), (3.5, False)])
def test_a_stone_that_was_pushed_and_turned_keeps_its_number(
    fakes, stage, database, away_m, is_found
):
    """What lies as far as it may have rolled, and is no other stone, is no new one.

    A stone from which jaws had slid lay 0.7 m away on another side, was taken for a new stone of an
    unknown weight, and lifted where it tips the machine.
    """
    database.weigh(1, Weight(1014.0, 27.0), 1.0)
    turned = stage.block((5.0, -away_m, 0.4), size=(0.6, 0.8, 1.0))
    context = fakes.Context(
        mapping=Mapper(np.vstack([turned, database.stone(2).points_map])),
        registration=Method(answer(T_FAR, False, "their forms differ")),
        segmentation=Method(None),
        objects=database,
    )
    context.plugins["segmentation"].segment = lambda cloud: Segmentation(
        "map",
        (Segment(0, turned, turned.mean(axis=0), np.ones(3)),),
        Cloud("map", np.empty((0, 3))),
        np.array([0, 0, 1.0, 0]),
    )
    outcome = fakes.finish(FindAgain(FindAgainSettings(), context), stone=1)
    assert outcome.success is is_found
    assert [one.id for one in database.stones()] == ([1, 2] if is_found else [1, 2, 3])
    stone = database.stone(1)
    assert stone.state is (StoneState.ON_GROUND if is_found else StoneState.LOST)
    assert stone.weight == Weight(1014.0, 27.0)
    if is_found:
        np.testing.assert_allclose(stone.centroid_map, turned.mean(axis=0), atol=0.02)
    lost = [kind for kind, _ in context.notes if kind == "stone_lost"]
    assert lost == ([] if is_found else ["stone_lost"])


@pytest.mark.parametrize(
    ("leaf", "told"), [(RelocateAndRealign, "kept the pose"), (FindAgain, "was not found")]
)
def test_a_registered_stone_whose_form_is_not_shown_there_is_not_recognised(fakes, leaf, told):
    """A block that was turned over: its unknown underside lies near its model turned back."""
    context = context_of(fakes, answer(T_NEAR, False, "no overlap"), answer(T_FAR, True))
    shown = context.plugins["mapping"].cloud().points
    worn = np.array([5.0, 0.0, 0.4]) + T_FAR[:3, 3]
    worn = worn + (shown - worn) * [0.9, 0.9, 1.0]
    context.plugins["mapping"] = Mapper(worn)
    context.plugins["segmentation"].segment = lambda cloud: Segmentation(
        "map", (), cloud, np.array([0, 0, 1.0, 0])
    )
    context.plugins["objects"].observe = lambda segments, stamp_s, from_above: ()
    settings = {RelocateAndRealign: RelocateAndRealignSettings, FindAgain: FindAgainSettings}
    outcome = fakes.finish(leaf(settings[leaf](), context), stone=1)
    assert not outcome.success
    assert told in outcome.reason
    assert context.plugins["objects"].moves == []


def test_the_surface_of_the_stones_below_is_not_taken_for_that_of_the_stone(fakes):
    context = context_of(fakes, NEAR, answer(T_FAR, True), stone(2, (5, 0.7, 0)))
    below = context.plugins["objects"].stone(2).points_map
    fakes.finish(RelocateAndRealign(RelocateAndRealignSettings(), context), stone=1)
    (shown,) = context.plugins["alignment"].asked
    seen = {tuple(point) for point in shown.points}
    is_ground = below[:, 2] < below[:, 2].min() + 0.2  # it may be of the ground: it is kept
    assert not seen & {tuple(point) for point in below[~is_ground]}
    assert len(seen) > 400


@pytest.mark.parametrize("is_shown", [True, False])
def test_a_stone_beside_which_the_map_shows_more_is_recognised_by_its_own_surface(fakes, is_shown):
    """The side of the stone that nobody had seen, or another stone in its place."""
    context = context_of(fakes, answer(np.eye(4), True), answer(T_FAR, False, "too small"))
    own = context.plugins["objects"].stone(1).points_map
    bulge = own[own[:, 0] > 5.0] + [0.25, 0, 0]
    middle = own.mean(axis=0)
    shown = own if is_shown else middle + (own - middle) * 0.85
    context.plugins["mapping"] = Mapper(np.vstack([shown, bulge]))
    outcome = fakes.finish(RelocateAndRealign(RelocateAndRealignSettings(), context), stone=1)
    assert outcome.success == is_shown
    assert len(context.plugins["objects"].moves) == is_shown
    assert is_shown or "of what the map shows there has the form of the model" in outcome.reason
