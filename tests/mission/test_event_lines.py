"""What a person reads of an event is one line with the figures that count."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.events import control, driving, fault, mission, site, stone, watch
from executive.events.event import Event
from executive.messages.drive import DriveTrouble
from executive.messages.verdict import Trouble
from executive.mission.event_lines import line_of

HERE, T = np.array([3.04, -7.06, 0.5]), np.eye(4)


def registered(accepted: bool, reason: str) -> site.SurveyRegistered:
    return site.SurveyRegistered(accepted, reason, 0.02, 0.9, 1.0, 4, T)


def segmented(left_out: tuple, *warnings: str) -> site.SiteSegmented:
    return site.SiteSegmented((1, 2, 3), (10, 20, 30), left_out, 0, warnings)


def planned(*standing: int) -> site.BuildingPlanned:
    return site.BuildingPlanned("wall", 5, T, standing, 0.1, 0.8, {}, {})


def ended(detail: str) -> site.BuildingEnded:
    return site.BuildingEnded("wall", "complete", detail, (1, 2), {})


def no_place(is_held: bool) -> site.PlaceNotFound:
    return site.PlaceNotFound("wall", 5, is_held, "nothing_fits", {"tilts": 9})


def realigned(accepted: bool, reason: str = "") -> stone.StoneRealigned:
    return stone.StoneRealigned(4, accepted, "alignment", reason, 0.01, 0.9, T)


def in_jaws(shift_m: float | None, turn_rad: float | None) -> stone.StoneSeenInJaws:
    return stone.StoneSeenInJaws(4, True, "too few points", 9, shift_m, turn_rad, None, None)


def asked(is_done: bool) -> control.ControlRequested:
    return control.ControlRequested("skip", "", "leaf 7", "ada", 1, 2, is_done, "no such leaf")


FAULT = SimpleNamespace(summary="motion plugin 'x': ValueError at x.py:3")
GRASP = stone.GraspRecord(T, 1.2, 1.0, {})
RELEASED = stone.StoneReleased(4, 2, HERE, T, T)

LINES = {
    "localised (GLOBAL)": site.Localised(T, "GLOBAL"),
    "drone map of 12 points": site.SiteSurveyed(12),
    "map of 34 points": site.SiteScanned(34),
    "drone map registered: 4 segments": registered(True, "4 segments"),
    "drone map refused: too few": registered(False, "too few"),
    "drone map shifted by 1.9 cm, at most 4.4 cm, and the map shows 86% of it": site.SurveyFitted(
        0.857, 0.0189, 0.0436
    ),
    "3 stones found": segmented(()),
    "3 stones found, 2 other things left out; dim; flat": segmented((1, 2), "dim", "flat"),
    "0 free places": site.SlotsFound(()),
    "wall: stone 5 is next": planned(),
    "wall: stone 5 is next on 2 that stand": planned(8, 9),
    "wall ends with 2 stones, complete": ended(""),
    "wall ends with 2 stones, complete: as drawn": ended("as drawn"),
    "wall: no place for stone 5, nothing_fits": no_place(False),
    "wall: no place for stone 5, as the jaws hold it, nothing_fits": no_place(True),
    "drives 8.2 m to (3.0, -7.1)": driving.DriveStarted(HERE, 8.21),
    "stands 0.12 m off the goal": driving.DriveEnded(HERE, 0.123, 0.5, 9.0),
    "stone 4: moving to a grasp": stone.AttemptStarted(4, HERE, GRASP, ()),
    "stone 5: moving to a grasp, 87% likely to be placed": stone.AttemptStarted(
        5, HERE, GRASP, (), 0.87
    ),
    "stone 4: grasped at 0.46 rad": stone.StoneGrasped(4, 0.456, 10, 0),
    "stone 4: nothing there": stone.JawsClosedOnNothing(4, "nothing there"),
    "stone 4: not lifted, 2399 kg hang in the jaws, and 2601 kg tip the machine there": (
        stone.StoneNotLifted(4, 0.1, 2399.0, 1540.2, tipping_kg=2601.0)
    ),
    "stone 4: not lifted, 1180 kg hang in the jaws, more than 937 kg": stone.StoneNotLifted(
        4, 0.2, 1180.0, 690.0, most_kg=937.4
    ),
    "stone 4: not lifted, 1306 of at least 1540 kg hang in the jaws": stone.StoneNotLifted(
        4, 0.2, 1305.6, 1540.2
    ),
    "stone 4: not lifted, 1306 of at least 1540 kg hang in the jaws, 1102 kg higher up": (
        stone.StoneNotLifted(4, 0.2, 1305.6, 1540.2, 1101.7)
    ),
    "stone 4: stands, -0.03 m from the planned height": stone.StoneTouchedDown(4, -0.034, 1.0),
    "stone 4: stands, +0.03 m from the planned height": stone.StoneTouchedDown(4, 0.034, 1.0),
    "stone 4: set down on slot 2": RELEASED,
    "stone 4: released where it was": stone.StoneLetGo(4, T),
    "stone 4: set aside, too heavy": stone.StoneSetAside(4, "too heavy"),
    "stone 4: realigned": realigned(True),
    "stone 4: not realigned: no overlap": realigned(False, "no overlap"),
    "stone 4: in the jaws 4.6 cm and 0.12 rad off": in_jaws(0.0456, 0.123),
    "stone 4: in the jaws kept as expected: too few points": in_jaws(None, None),
    "not carried on: stone 4 has turned": stone.StoneSeenInJaws(
        4, False, "too few points", 9, None, None, None, None, "stone 4 has turned"
    ),
    "stone 4: weighs 812 ± 15 kg": stone.StoneWeighed(4, 812.3, 14.6),
    "stone 4: lost, it fell": stone.StoneLost(4, "it fell"),
    "drop: 900 kg gone": mission.VerdictGiven("scale", Trouble.DROP, "900 kg gone"),
    f"warning: {FAULT.summary}": mission.PluginFailed(FAULT),
    "warning: no plugin takes observations of type Odour": mission.ObservationIgnored("Odour"),
    "warning: a tick was 51 ms late (3 in a row)": mission.TickLate(0.0512, 3),
    "arm and jaws at rest 1.5 s after a cancel": mission.PartsReleased(("arm", "jaws"), 1.52),
    "warning: the stop failed: no answer": mission.StopFailed("no answer"),
    "holding": mission.PhaseChanged("running", "holding", ""),
    "holding: gnss": mission.PhaseChanged("running", "holding", "gnss"),
    "fault 2 on purpose: imu silent": fault.FaultInjected(2, "imu", "silent", False),
    "fault 2 on purpose shows: 0.123 off the path": fault.FaultShows(2, 0.1234),
    "fault 2 on purpose is over": fault.FaultRemoved(2, "imu", "silent", 5),
    "warning: gnss: an observation is refused: NaN": watch.ObservationRefused("gnss", "NaN", 1.0),
    "warning: gnss_left: samples are missing, gap 4": watch.SamplesMissing("gnss_left", 4),
    "warning: gnss is silent": watch.ConditionBroken("gnss", "gnss is silent"),
    "gnss is well again after 2.5 s": watch.ConditionRestored("gnss", 2.49),
    "warning: scans are not fused: no pose": watch.ScansNotFused("no pose"),
    "goes on after a hold of 3.5 s: all well": watch.MissionWentOn(3.46, "all well", 0.0, 0.0),
    "ada asks: skip leaf 7 is refused: no such leaf": asked(False),
    "ada asks: skip leaf 7: no such leaf": asked(True),
}


@pytest.mark.parametrize(("line", "event"), LINES.items(), ids=list(LINES))
def test_an_event_is_one_line(line: str, event: Event) -> None:
    assert line_of(event) == line


def test_a_drive_that_fails_tells_its_trouble_and_the_reason() -> None:
    trouble = next(iter(DriveTrouble))
    line = line_of(driving.DriveFailed(trouble, "a ditch", T))
    assert line == f"does not drive on: {trouble}, a ditch"


@pytest.mark.parametrize("seen", ["off", "unseen"])
def test_a_placed_stone_is_worth_a_line_only_if_it_is_not_as_planned(seen: str) -> None:
    wrong = stone.PlacementVerified(4, 2, seen, 0.4, 0.1, "keep", "0.40 m off")
    assert line_of(wrong) == f"stone 4: {seen}, 0.40 m off"
    assert line_of(stone.PlacementVerified(4, 2, "placed", 0.01, 0.0, "", "")) == ""


@pytest.mark.parametrize(
    "event", [mission.PauseEnded(3.0), site.RoundBegun((1,)), stone.ArrivedEarly(0.1, 0.2)]
)
def test_what_nobody_waits_for_is_no_line(event: Event) -> None:
    assert line_of(event) == ""
