"""Where a stone that is not as expected is sought in the jaws, and which find counts."""

import numpy as np
import pytest

from executive.behaviours import see_held
from executive.behaviours.see_held import SeeHeld, _is_apart
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.alignment import Aligner
from executive.leaf.form_evidence import FormEvidence
from executive.leaf.held_starts import held_starts
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold

HOLD = Hold(1, np.eye(4), 0.6)
MODEL = np.random.default_rng(0).uniform(-0.4, 0.4, (50, 3)) + [0.9, 0.0, 0.0]
VIEW = Cloud("gripper", MODEL[:20])
LOG_1000 = np.log(1000.0)  # a thousand times likelier, as is asked for
HERE, THERE = pose(t=np.array([0.1, 0.0, 0.0])), pose(t=np.array([0.3, 0.0, 0.0]))


class Jaws:
    """A look whose alignments are given: first at the expected pose, then from each start."""

    def __init__(self, fakes, stage, monkeypatch, found, refused_log=0.0, alike=0.25):
        self.alike = alike
        self.refused_log = refused_log  # of a view whose alignment is refused
        self.found, self.starts, self.likely = found, [], []
        monkeypatch.setattr(see_held, "form_evidence", self._form)
        context = fakes.Context(alignment=stage.Scripted(Aligner, align=self._align))
        self.leaf = SeeHeld(SeeHeld.Settings(), context)
        self.context = context

    def _align(self, target, source, **start):
        number = len(self.starts)
        self.starts.append(next(v for v in start.values() if np.shape(v) == (4, 4)))
        np.testing.assert_array_equal(target.points, MODEL)
        assert source is self.view
        T, log_ratio = self.found.get(number, (np.eye(4), None))
        self.likely.append(self.refused_log if log_ratio is None else log_ratio)
        return Alignment(T, log_ratio is not None, "far off", 0.01, 0.9)

    def _form(self, seen, model, reach_m, *, hangs):
        assert hangs
        np.testing.assert_array_equal(model, MODEL)
        assert reach_m == 0.3
        return FormEvidence(self.likely[-1], self.alike)

    def seen(self, view=VIEW):
        self.view = view
        steps, answer = self.leaf._seen(HOLD, MODEL, view), None
        try:
            while True:
                waiting = steps.send(answer)
                answer = waiting.result() if waiting is not None else None
        except StopIteration as end:
            return end.value


@pytest.fixture
def jaws(fakes, stage, monkeypatch):
    return lambda found, **given: Jaws(fakes, stage, monkeypatch, found, **given)


def test_a_stone_that_is_as_expected_is_sought_nowhere_else(jaws):
    look = jaws({0: (HERE, 0.0)})
    found = look.seen()
    assert (found.aligned.accepted, found.is_otherwise) == (True, False)
    np.testing.assert_array_equal(found.aligned.T_target_source, HERE)
    np.testing.assert_array_equal(look.starts, [np.eye(4)])


def test_a_stone_that_is_refused_is_sought_from_every_start(jaws):
    look = jaws({})
    found = look.seen()
    assert (found.aligned.accepted, found.aligned.reason) == (False, "far off")
    assert not found.is_otherwise  # its view says nothing against the expected pose
    tips = look.context.machine().gripper.tips(0.6)
    starts = held_starts(tips, MODEL, np.array([0.0, 0.0, -1.0]))
    np.testing.assert_allclose(look.starts[1:], [inverse(T) for T in starts])


def test_a_refused_view_of_another_surface_contradicts_the_expected_pose(jaws):
    found = jaws({}, refused_log=-LOG_1000 - 0.01).seen()
    assert (found.aligned.reason, found.is_otherwise) == ("far off", True)
    assert not jaws({}, refused_log=-LOG_1000).seen().is_otherwise
    # Where it is found in another pose, nothing is contradicted.
    found = jaws({3: (HERE, 2.0 * LOG_1000)}, refused_log=-LOG_1000 - 0.01).seen()
    assert (found.aligned.accepted, found.is_otherwise) == (True, False)
    # A look without a return says nothing.
    assert not jaws({}, refused_log=-LOG_1000 - 0.01).seen(Cloud("gripper", MODEL[:0])).is_otherwise


def test_the_likeliest_find_counts_if_another_is_far_less_likely(jaws):
    finds = {3: (HERE, LOG_1000 + 0.1), 5: (THERE, 2.5 * LOG_1000), 7: (HERE, LOG_1000 + 0.2)}
    found = jaws(finds).seen()
    assert (found.aligned.accepted, found.is_otherwise) == (True, False)
    np.testing.assert_array_equal(found.aligned.T_target_source, THERE)


def test_two_places_that_are_nearly_as_likely_are_none(jaws):
    finds = {3: (HERE, 2.0 * LOG_1000), 5: (THERE, 2.9 * LOG_1000)}
    found = jaws(finds).seen()
    assert not found.aligned.accepted
    assert found.aligned.reason == "it may lie in the jaws in two ways"
    assert found.is_otherwise


def test_two_finds_of_one_place_are_one(jaws):
    near = pose(t=np.array([0.3, 0.05, 0.0]))
    found = jaws({3: (near, 2.0 * LOG_1000), 5: (THERE, 2.9 * LOG_1000)}).seen()
    assert found.aligned.accepted
    np.testing.assert_array_equal(found.aligned.T_target_source, THERE)


def test_a_find_has_to_be_a_thousand_times_likelier_than_another_surface(jaws):
    assert not jaws({3: (HERE, LOG_1000 - 0.01)}).seen().aligned.accepted
    assert jaws({3: (HERE, LOG_1000)}).seen().aligned.accepted


def test_another_form_where_the_stone_is_expected_is_told_and_the_stone_sought(jaws):
    look = jaws({0: (HERE, -LOG_1000 - 0.01)})
    found = look.seen()
    told = "25% of what is seen in the jaws has the form of the stone"
    assert (found.aligned.accepted, found.aligned.reason) == (False, told)
    assert found.is_otherwise
    for alike, is_otherwise in ((0.55, True), (0.56, False)):  # as much as where another one lies
        look = jaws({0: (HERE, -LOG_1000 - 0.01)}, alike=alike)
        assert look.seen().is_otherwise is is_otherwise
    assert len(look.starts) > 20
    assert jaws({0: (HERE, -LOG_1000)}).seen().aligned.accepted


def test_a_stone_that_has_turned_far_may_lie_otherwise_too(jaws):
    turned = pose(from_rpy(0.0, 0.5, 0.0))  # more than 25°, from where the next start begins
    look = jaws({0: (turned, 0.0)})
    assert look.seen().aligned.accepted
    assert len(look.starts) > 20
    look = jaws({0: (pose(from_rpy(0.0, 0.4, 0.0)), 0.0)})
    look.seen()
    assert len(look.starts) == 1


@pytest.mark.parametrize(
    ("shift_m", "turn_rad", "is_apart"),
    [(0.09, 0.0, False), (0.11, 0.0, True), (0.0, 0.14, False), (0.0, 0.16, True)],
)
def test_motions_are_two_beyond_10_cm_or_0_15_rad_at_the_middle(shift_m, turn_rad, is_apart):
    centre = np.array([0.9, 0.2, -0.1])
    R = from_rpy(0.0, 0.0, turn_rad)
    T_moved = pose(R, centre - R @ centre + [shift_m, 0.0, 0.0])  # about the middle
    begin = pose(from_rpy(0.3, -0.2, 0.5), np.array([0.5, 0.1, 0.2]))
    one = Alignment(inverse(T_moved @ begin), True, "", 0.01, 0.9)
    other = Alignment(inverse(begin), True, "", 0.01, 0.9)
    assert _is_apart(one, other, centre) is is_apart
