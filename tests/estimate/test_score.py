"""A score is what evo would print, and a reference that does not fit gives one sentence."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.errors import ConfigError, DataError
from executive.estimate import score as module
from executive.estimate.score import report, scored, summary, with_score
from executive.estimate.trajectory import Trajectory, read_trajectory
from executive.messages.base_state import BaseState

ORIGIN_S = 1000.0
STD_M = 0.1


def states(n=200, seed=1):
    """A circle, with errors of the declared covariance."""
    rng = np.random.default_rng(seed)
    truth, found = [], []
    for k in range(n):
        t = 0.1 * k
        R = Rotation.from_euler("z", 0.2 * t).as_matrix()
        p = np.array([10 * np.cos(0.2 * t), 10 * np.sin(0.2 * t), 0.0])
        T = np.eye(4)
        T[:3, :3] = R @ Rotation.from_rotvec(rng.normal(0, 0.01, 3)).as_matrix()
        T[:3, 3] = p + rng.normal(0, STD_M, 3)
        P = np.diag(np.repeat([0.01**2, STD_M**2], 3))
        found.append(BaseState(t, T, T, T, np.zeros(3), np.zeros(3), P, "GLOBAL"))
        truth.append((ORIGIN_S + t, p, R))
    return found, Trajectory(*(np.array(column) for column in zip(*truth, strict=True)))


def moved(one, yaw=0.0, roll=0.0, shift=(0.0, 0.0, 0.0)):
    R = Rotation.from_euler("xz", [roll, yaw]).as_matrix()
    return Trajectory(one.stamps_s, one.p @ R.T + shift, R @ one.R)


@pytest.mark.parametrize(
    ("alignment", "move"),
    [
        ("none", {}),
        ("yaw", {"yaw": 1.0, "shift": (5.0, 0.0, 2.0)}),
        ("se3", {"yaw": 1.0, "roll": 0.5, "shift": (5.0, 0.0, 2.0)}),
    ],
)
def test_errors_are_those_that_were_made_whatever_the_alignment_takes_away(alignment, move):
    found, truth = states()
    pair = scored(found, ORIGIN_S, moved(truth, **move), alignment)
    figures = report(pair, alignment, [(ORIGIN_S + 5, ORIGIN_S + 8)])
    assert figures["ape_m"]["rms"] == pytest.approx(np.sqrt(3) * STD_M, rel=0.1)
    assert figures["ape_rad"]["rms"] == pytest.approx(np.sqrt(3) * 0.01, rel=0.2)
    assert figures["rpe"]["1 s"]["m"]["rms"] == pytest.approx(np.sqrt(6) * STD_M, rel=0.1)
    assert figures["nees"]["inside_95"] > 0.9
    (outage,) = figures["outages"]
    assert outage["way_m"] == pytest.approx(6.0, abs=0.3)
    assert outage["status_at_end"] == "GLOBAL"


def test_without_alignment_a_shift_of_the_reference_counts():
    found, truth = states()
    pair = scored(found, ORIGIN_S, moved(truth, shift=(5.0, 0.0, 0.0)), "none")
    figures = report(pair, "none", [])
    assert figures["ape_m"]["median"] == pytest.approx(5.0, abs=0.1)
    assert figures["nees"]["inside_95"] == 0.0


def test_positions_alone_are_scored_without_orientation():
    found, truth = states()
    bare = Trajectory(truth.stamps_s, truth.p, np.tile(np.eye(3), (len(truth.p), 1, 1)))
    figures = report(scored(found, ORIGIN_S, bare, "none"), "none", [])
    assert figures["ape_rad"] is None
    assert figures["nees"]["degrees"] == 3


def test_a_reference_of_another_time_is_refused_with_both_times():
    found, truth = states()
    with pytest.raises(DataError, match=r"0 times in common; the reference is of 10000\.000 to"):
        scored(found, ORIGIN_S - 9000, Trajectory(truth.stamps_s + 9000, truth.p, truth.R), "none")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1 2 3\n", r"ref.tum:1: expected eight numbers"),
        ("# only this\n", "0 poses; a reference needs two"),
        ("1 0 0 0 0 0 0 9\n", "quaternion of length 9"),
        ("1 0 0 0 0 0 0 x\n", "expected eight numbers"),
    ],
)
def test_a_file_that_is_no_trajectory_is_refused_with_its_line(text, says, tmp_path):
    path = tmp_path / "ref.tum"
    path.write_text(text)
    with pytest.raises(DataError, match=says):
        read_trajectory(path, None)
    with pytest.raises(ConfigError, match="is no log"):
        read_trajectory(path, "/pose")


def test_a_motion_between_two_stamps_is_seen_from_where_it_begins():
    """Where the heading is off by a constant, each shift is turned by it about the beginning."""
    found, truth = states()
    quiet = [
        BaseState(s.stamp_s, s.T_map_base, s.T_odom_base, pose(t_p, t_R), s.v_map_cabin,
                  s.w_map_cabin_in_cabin, s.covariance, s.status)
        for s, t_p, t_R in zip(found, truth.p, truth.R, strict=True)
    ]  # fmt: skip
    rolled = Trajectory(truth.stamps_s, truth.p, truth.R @ TILT)
    figures = report(scored(quiet, ORIGIN_S, rolled, "none"), "none", [])
    way_m = 2 * 10 * np.sin(0.1)  # chord of a second on the circle
    off_m = 2 * np.sin(0.25) * way_m  # of a vector that is turned by half a radian
    assert figures["rpe"]["1 s"]["m"]["max"] == pytest.approx(off_m, abs=2e-3)
    assert figures["rpe"]["1 s"]["rad"]["max"] == pytest.approx(0.0, abs=1e-3)


def test_the_error_at_the_end_of_an_outage_is_that_of_its_last_state():
    found, truth = states()
    shifted = truth.p.copy()
    shifted[79] += (0.0, 0.0, 30.0)  # the last state before 8 s
    shifted[70] += (0.0, 0.0, 50.0)
    reference = Trajectory(truth.stamps_s, shifted, truth.R)
    figures = report(
        scored(found, ORIGIN_S, reference, "none"), "none", [(ORIGIN_S + 5, ORIGIN_S + 8)]
    )
    (outage,) = figures["outages"]
    assert outage["error_at_end_m"] == pytest.approx(30.0, abs=0.5)
    assert outage["max_error_m"] == pytest.approx(50.0, abs=0.5)


TILT = Rotation.from_euler("z", 0.5).as_matrix()


def pose(p, R):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def test_the_times_of_an_outage_are_told_to_the_millisecond():
    found, truth = states()
    span = (ORIGIN_S + 5.00049, ORIGIN_S + 8.00151)
    (outage,) = report(scored(found, ORIGIN_S, truth, "none"), "none", [span])["outages"]
    told = outage["from_s"] - ORIGIN_S, outage["to_s"] - ORIGIN_S
    assert told == pytest.approx((5.0, 8.002), abs=1e-9)


def test_an_outage_without_states_is_left_out():
    found, truth = states()
    spans = [(ORIGIN_S + 100, ORIGIN_S + 101), (ORIGIN_S + 5, ORIGIN_S + 6)]
    (outage,) = report(scored(found, ORIGIN_S, truth, "none"), "none", spans)["outages"]
    assert outage["from_s"] == ORIGIN_S + 5


def test_an_estimate_without_a_heading_is_not_scored():
    found, truth = states()
    lost = [replace(state, status="ALIGNING") for state in found]
    with pytest.raises(DataError, match="no state with a heading"):
        scored([*lost[1:], found[0]], ORIGIN_S, truth, "none")


def test_a_score_in_one_line_gives_its_figures_with_their_units():
    figures = {
        "poses": 7, "alignment": "yaw", "ape_m": {"rms": 0.1236, "median": 0.1, "p95": 0.31},
        "nees": {"inside_95": 0.936}, "outages": [{}, {}],
    }  # fmt: skip
    assert summary(figures) == (
        "score over 7 poses, alignment yaw: APE rms 0.124 m, median 0.100 m, 95 % 0.310 m; "
        "94 % of the errors within the 95 % bound of the covariance; 2 times without fixes"
    )


@dataclass(frozen=True)
class Replayed:
    replay: object
    report: dict


def test_a_score_is_added_to_the_report_at_the_times_of_the_log(monkeypatch):
    found, truth = states()
    monkeypatch.setattr(module, "silences", lambda material: [(5.05, 8.05)])
    material = SimpleNamespace(log=SimpleNamespace(origin_ns=int(ORIGIN_S * 1e9)))
    estimated = Replayed(SimpleNamespace(states=found), {"kept": 1})
    scored_one = with_score(material, estimated, truth, "none")
    assert scored_one.report["kept"] == 1
    span = [(ORIGIN_S + 5.05, ORIGIN_S + 8.05)]
    expected = report(scored(found, ORIGIN_S, truth, "none"), "none", span)
    assert scored_one.report["score"] == expected
    assert len(expected["outages"]) == 1
    assert estimated.report == {"kept": 1}
