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

RNG = np.random.default_rng(0)
T_NEAR, T_FAR = pose(None, np.array([0.1, 0, 0])), pose(None, np.array([1.0, 0.5, 0]))


def stone(number, centre, state=StoneState.PLACED):
    points = RNG.uniform(-0.4, 0.4, (500, 3)) + centre
    return Stone(
        number, state, points, points.mean(axis=0), pose(None, np.array(centre, dtype=float)), True
    )


def answer(T, accepted, reason="as told"):
    return Alignment(T, accepted, reason, 0.02, 0.8)


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
    points = np.vstack([own.points_map, *[other.points_map for other in others]])
    return fakes.Context(
        mapping=Mapper(points), alignment=Method(aligned), registration=Method(found),
        segmentation=Method(None),
        objects=Objects(own, *others),
    )  # fmt: skip


def test_what_the_aligner_accepts_is_done_and_nobody_else_asked(fakes):
    context = context_of(fakes, answer(T_NEAR, True), answer(T_FAR, True))
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
