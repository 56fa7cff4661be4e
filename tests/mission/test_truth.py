"""The report's truth compares the mission's view, on the machine's time, with the simulator."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive import registry
from executive.clock import SimulatedClock
from executive.events.site import SurveyRegistered
from executive.events.stone import GraspRecord, StoneReleased
from executive.interfaces.oracle import Witness
from executive.interfaces.truth import TrueStructure, Truth
from executive.messages.cloud import Cloud
from executive.messages.stone import StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.structure import Structure
from executive.mission import truth as truth_module
from executive.mission.picks import Pick, Try
from executive.mission.truth import truth_of, witness_of
from executive.testing.blank import blank

ROBOT = object()


@pytest.fixture
def seen(monkeypatch):
    """The views that an oracle was asked about; it answers with their number."""
    views = []

    def load(group, name):
        assert (group, name) == (registry.ORACLES, "toy")

        def oracle(robot):
            assert robot is ROBOT
            return SimpleNamespace(truth=lambda view: views.append(view) or len(views))

        return oracle

    monkeypatch.setattr(registry, "load", load)
    return views


def paused_clock():
    """Return a clock that was paused after 2 s, for 3 s."""
    clock = SimulatedClock()
    for tick in range(10):
        if tick == 2:
            clock.pause()
        if tick == 5:
            clock.resume()
        clock.advance(1.0)
    return clock


def mission(*, registered=None, survey=None, **plugins):
    return SimpleNamespace(
        services=SimpleNamespace(plugins=plugins),
        clock=paused_clock(),
        guard=SimpleNamespace(judged=["state 1", "state 2"]),
        account=SimpleNamespace(registered=registered),
        survey=survey,
    )


def tried(stone, started_s, ended_s):
    grasp = GraspRecord(*[None] * len(GraspRecord.__dataclass_fields__))
    return Try(stone, started_s, grasp, (1.0, 2.0, 3.0), ended_s, "released")


def released(stone, slot):
    return StoneReleased(stone, slot, np.array([slot, 0.0, 0.0]), np.eye(4), np.eye(4))


def test_without_stones_and_a_map_only_the_states_are_compared(seen):
    assert truth_of(ROBOT, "toy", mission(), []) == 1
    (view,) = seen
    assert view.states == ("state 1", "state 2")
    assert (view.stones, view.slots, view.attempts) == ((), {}, [])
    assert (view.histories, view.map_cloud, view.registered_survey) == (None, None, None)


def test_stones_and_attempts_are_told_on_the_machines_time(seen):
    event = StoneEvent(4.0, "moved", StoneState.HELD, np.eye(4), "by the arm")
    stones = [SimpleNamespace(id=7)]
    objects = SimpleNamespace(stones=lambda: stones, history={7: [event]}.__getitem__)
    mapper = SimpleNamespace(cloud=lambda: "the map")
    picks = [
        Pick(7, is_verified=False, tries=[tried(7, 1.0, 3.0)], released=released(7, 2)),
        Pick(8, is_verified=False),
    ]
    truth_of(ROBOT, "toy", mission(objects=objects, mapping=mapper), picks)
    (view,) = seen
    assert (view.stones, view.map_cloud) == (stones, "the map")
    ((number, (told,)),) = view.histories.items()
    assert (number, told.stamp_s, told.kind, told.note) == (7, 7.0, "moved", "by the arm")
    (attempt,) = view.attempts
    assert (attempt.stone_id, attempt.started_s, attempt.ended_s) == (7, 1.0, 6.0)
    assert (attempt.outcome, attempt.grasp_centroid_map) == ("released", (1.0, 2.0, 3.0))
    ((stone, slot),) = view.slots.items()
    assert (stone, slot.id, slot.position_map.tolist()) == (7, 2, [2.0, 0.0, 0.0])


def test_the_newest_pick_of_a_stone_decides_on_its_slot(seen):
    picks = [
        Pick(1, is_verified=False, released=released(1, 4)),
        Pick(1, is_verified=False, released=released(1, 5)),
        Pick(2, is_verified=False, released=released(2, 6)),
        Pick(2, is_verified=False, set_aside="too heavy"),
    ]
    truth_of(ROBOT, "toy", mission(), picks)
    assert {stone: slot.id for stone, slot in seen[0].slots.items()} == {1: 5}


def test_a_survey_is_laid_over_the_map_with_its_scale_as_it_was_last_accepted(seen):
    quarter = np.array([[0.0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 30], [0, 0, 0, 1]])
    found = SurveyRegistered(True, "", 0.1, 0.5, 2.0, 3, quarter)
    survey = Cloud("drone", np.array([[1.0, 2.0, 3.0]]))
    truth_of(ROBOT, "toy", mission(registered=found, survey=survey), [])
    cloud = seen[0].registered_survey
    assert (cloud.frame, cloud.points.tolist()) == ("map", [[6.0, 22.0, 36.0]])
    truth_of(ROBOT, "toy", mission(registered=found), [])
    truth_of(ROBOT, "toy", mission(survey=survey), [])
    assert [view.registered_survey for view in seen[1:]] == [None, None]


WALL, CAIRN = (Structure(name, np.zeros((1, 2)), 1.0, 1.0) for name in ("wall", "cairn"))


@pytest.fixture
def judged(monkeypatch):
    """The structures that a judge was handed, by its name; it finds that each drifts by 1 cm."""
    found = {"wall": SimpleNamespace(standing=("a stone",)), "cairn": SimpleNamespace(standing=())}
    asked = []

    def oracle(robot):
        names = lambda view: tuple(TrueStructure(one.name, (), (), ()) for one in view.structures)
        return SimpleNamespace(
            truth=lambda view: blank(Truth, structures=names(view)),
            as_built=lambda structure: found[structure.name],
        )

    def verdict_of(built, name):
        asked.append((built, name))
        return {"drift_20s_m": 0.01}

    monkeypatch.setattr(registry, "load", lambda group, name: oracle)
    monkeypatch.setattr(truth_module, "verdict_of", verdict_of)
    return asked, found


def test_a_judge_is_handed_what_really_stands_and_nothing_where_no_stone_does(judged):
    asked, found = judged
    truth = truth_of(ROBOT, "toy", mission(), [], (WALL, CAIRN), "rigid_stones")
    assert asked == [(found["wall"], "rigid_stones")]
    verdicts = {one.name: dict(one.verdict) for one in truth.structures}
    assert verdicts == {"wall": {"drift_20s_m": 0.01}, "cairn": {}}


def test_without_a_judge_or_an_oracle_that_knows_the_stones_there_is_no_verdict(judged):
    asked, found = judged
    truth = truth_of(ROBOT, "toy", mission(), [], (WALL,), registry.NO_JUDGE)
    found["wall"] = None
    also = truth_of(ROBOT, "toy", mission(), [], (WALL,), "rigid_stones")
    assert asked == []
    assert [dict(one.verdict) for one in (*truth.structures, *also.structures)] == [{}, {}]


def test_a_judge_that_fails_costs_its_verdict_and_no_more(judged, monkeypatch, caplog):
    def fails(built, name):
        raise RuntimeError("no contact")

    monkeypatch.setattr(truth_module, "verdict_of", fails)
    judged[1]["wall"].structure = WALL
    (found,) = truth_of(ROBOT, "toy", mission(), [], (WALL,), "strict").structures
    assert dict(found.verdict) == {}
    assert "the judge 'strict' gave no verdict on 'wall'" in caplog.text
    assert "no contact" in caplog.text


class Robot(Witness):
    """A robot that can read the truth of another."""

    def __init__(self, told):
        self._told = told

    def write_truth(self, path): ...

    def read_truth(self, path, zero_s):
        self._told.append(("read", path, zero_s))


@pytest.mark.parametrize("fails", [False, True])
@pytest.mark.parametrize("is_witness", [True, False])
def test_a_witness_is_an_equal_robot_that_reads_what_the_other_wrote(
    monkeypatch, tmp_path, is_witness, fails
):
    told = []
    robot = Robot(told) if is_witness else ROBOT
    assembly = SimpleNamespace(
        start=lambda: told.append("start"), close=lambda: told.append("close"),
        plugins={"robot": robot},
    )  # fmt: skip
    monkeypatch.setattr(truth_module, "needed_for", lambda chosen, what: (chosen, what))
    monkeypatch.setattr(truth_module, "assemble", lambda *given: told.append(given) or assembly)

    def look():
        with witness_of("selections", "m545", 3, tmp_path, 1.5) as found:
            assert found is robot
            told.append("look")
            if fails:
                raise LookupError

    if fails:
        with pytest.raises(LookupError):
            look()
    else:
        look()
    read = [("read", tmp_path, 1.5)] if is_witness else []
    made = (("selections", "robot"), "m545", 3)
    assert told == [made, "start", *read, "look", "close"]
