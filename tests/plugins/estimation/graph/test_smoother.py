"""The smoother in this process: what it uses, refuses and does without fixes, at rest."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix, Increment
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.odometry_use import OdometryUse
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.smoother import GraphSmoother
from executive_plugins.estimation.graph.window import GraphWindow, UnsolvableError
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import POSITION, Inertial, InertialState
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.modes import Mode

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
UP = np.array([0.0, 0.0, 9.81])
ARM = np.array([1.0, 0.5, 2.0])
Z = np.zeros(3)


class AtRest:
    """A body at rest at the origin; its samples come every 10 ms."""

    def __init__(self, **settings: object) -> None:
        state = InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), Z, Z, Z, Z)
        self.smoother = GraphSmoother(
            SmootherSettings(**settings), NOISE, GraphEstimate(state, 1e-4 * np.eye(15))
        )
        self.k, self.answers, self.lidar_std_m = 0, [], 1e-3

    @property
    def now_s(self) -> float:
        return self.k / 100

    def until(
        self, stamp_s: float, off_m: float | None = None, has_lidar: bool = False
    ) -> Estimate:
        """Go on, with a fix every 0.2 s that is off, if there are any; return the last answer."""
        while self.now_s < stamp_s - 1e-9:
            self.k += 1
            self.smoother.add_sample(Inertial(self.now_s, Z, UP, 0.01))
            if off_m is not None and self.k % 20 == 0:
                self.fix(self.now_s, off_m)
            if has_lidar and self.k % 20 == 0:
                P = np.diag(np.repeat([1e-6, self.lidar_std_m**2], 3))
                self.smoother.add(Increment(self.now_s - 0.2, self.now_s, np.eye(4), P))
            if self.smoother.is_due:
                self.answers.append(self.smoother.update())
        return self.answers[-1]

    def fix(self, stamp_s: float, off_m: float = 0.0) -> None:
        p = ARM + np.array([off_m, 0.0, 0.0])
        self.smoother.add(Fix(stamp_s, "left", ARM, p, 1e-4 * np.eye(3)))

    def refused(self) -> dict[str, int]:
        total: dict[str, int] = {}
        for answer in self.answers:
            for name, count in answer.refused.items():
                total[name] = total.get(name, 0) + count
        return total

    def modes(self) -> list[tuple[Mode, str]]:
        return [(change.after, change.reason) for a in self.answers for change in a.changes]


def fail_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the next solution of a graph fail."""
    solve, fails = GraphWindow.solve, [True]

    def solved(window: GraphWindow) -> None:
        if fails.pop() if fails else False:
            raise UnsolvableError("not positive definite")
        solve(window)

    monkeypatch.setattr(GraphWindow, "solve", solved)


def test_with_good_fixes_it_stays_where_it_is() -> None:
    rest = AtRest()
    answer = rest.until(2.0, off_m=0.0)
    assert (answer.mode, rest.modes(), rest.refused()) == (Mode.GLOBAL, [], {})
    assert answer.state.stamp_s == 2.0
    assert answer.state.p_map_imu == pytest.approx(Z, abs=1e-3)


def test_a_measurement_waits_for_its_sample() -> None:
    rest = AtRest()
    rest.until(0.5, off_m=0.0)
    count = len(rest.answers)
    rest.fix(0.55)
    assert rest.smoother.is_waiting
    assert not rest.smoother.is_due
    rest.until(0.54)
    assert len(rest.answers) == count
    rest.until(0.55)
    assert len(rest.answers) == count + 1
    assert not rest.smoother.is_waiting
    assert rest.answers[-1].state.stamp_s == 0.55


def test_without_measurements_there_is_a_node_every_half_second() -> None:
    rest = AtRest()
    rest.until(1.6)
    assert [answer.state.stamp_s for answer in rest.answers] == [0.5, 1.0, 1.5]


def test_silence_is_told_after_its_times() -> None:
    rest = AtRest(node_after_s=0.05)
    rest.until(1.2)
    told = [change for answer in rest.answers for change in answer.changes]
    assert 0.6 < told[0].stamp_s < 0.66
    assert 1.0 < told[1].stamp_s < 1.06
    assert [change.after for change in told] == [Mode.SUSPECT, Mode.FALLBACK]
    assert told[0].reason.startswith("no fix for 0.6")
    assert told[1].reason.startswith("no good fix for 1.")


def test_a_fix_that_is_far_off_is_refused_and_then_the_others_are_missed() -> None:
    rest = AtRest()
    rest.until(1.0, off_m=0.0)
    answer = rest.until(2.4, off_m=3.0)
    assert answer.state.p_map_imu == pytest.approx(Z, abs=1e-2)
    assert [mode for mode, _ in rest.modes()] == [Mode.SUSPECT, Mode.FALLBACK, Mode.RECOVERING]
    assert rest.modes()[0][1] == "left 3.00 m off the estimate"
    # From 1.2 s to 2.2 s refused; then one during recovery.
    assert rest.refused() == {"left: outlier": 6, "left: during recovery": 1}


def test_fixes_that_agree_again_are_used_again() -> None:
    rest = AtRest()
    rest.until(1.0, off_m=0.0)
    rest.until(3.0, has_lidar=True)
    answer = rest.until(4.2, off_m=0.05, has_lidar=True)
    assert answer.mode == Mode.GLOBAL
    assert rest.modes()[-1][1].startswith("5 fixes in a row agree, ")
    assert rest.refused() == {"left: during recovery": 5}
    assert 0.01 < answer.state.p_map_imu[0] < 0.06  # all five are used


def drifting(rest: "AtRest") -> None:
    """Let fixes drift from the odometry by 0.2 m/s until that is told."""
    rest.lidar_std_m = 0.03
    rest.until(4.0, off_m=0.0, has_lidar=True)
    for _ in range(20):
        rest.until(rest.now_s + 0.2, off_m=0.2 * (rest.now_s - 3.8), has_lidar=True)
        if rest.modes():
            break
    assert "drifted" in rest.modes()[0][1]
    assert rest.now_s < 6.0
    assert rest.answers[-1].mode == Mode.SUSPECT


def test_fixes_that_drift_from_the_odometry_are_used_and_the_state_is_in_doubt() -> None:
    """Odometry that drifts looks the same; inertial samples agree with either."""
    rest = AtRest(fallback_after_s=10.0, gate={"innovation": 1e9})
    drifting(rest)
    off_m = 0.2 * (rest.now_s - 4.0)
    rest.until(rest.now_s + 2.0, off_m=off_m, has_lidar=True)
    assert rest.refused() == {}
    assert rest.answers[-1].state.p_map_imu == pytest.approx([off_m, 0.0, 0.0], abs=0.1)
    assert rest.answers[-1].mode == Mode.SUSPECT


def test_a_doubt_that_lasts_ends_for_the_fixes() -> None:
    rest = AtRest(fallback_after_s=10.0, gate={"innovation": 1e9, "unlock_after_s": 2.0})
    drifting(rest)
    rest.until(rest.now_s + 3.0, off_m=0.2 * (rest.now_s - 4.0), has_lidar=True)
    assert rest.answers[-1].mode == Mode.GLOBAL


def test_a_drift_that_inertial_samples_contradict_takes_back_the_fixes_of_its_window(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(OdometryUse, "gives_way", lambda self: False)
    rest = AtRest(fallback_after_s=10.0, gate={"innovation": 1e9})
    drifting(rest)
    # The fixes of three seconds are without effect now, also the good ones among them.
    before, after = rest.answers[-2:]
    assert before.state.p_map_imu[0] > 0.1
    assert after.state.p_map_imu == pytest.approx(Z, abs=1e-3)
    assert np.trace(after.covariance[POSITION, POSITION]) > 0.01


def test_what_is_older_than_the_window_is_refused_by_its_name() -> None:
    rest = AtRest(lag_s=0.5)
    rest.until(2.0, off_m=0.0)
    rest.fix(1.2)
    rest.smoother.add(Increment(1.0, 1.2, np.eye(4), 1e-6 * np.eye(6)))
    rest.until(2.2, off_m=0.0)
    assert rest.refused() == {"left: too late": 1, "increment: too late": 1}
    assert rest.answers[-1].mode == Mode.GLOBAL


def test_a_late_fix_within_the_window_is_used() -> None:
    rest = AtRest()
    rest.until(1.0, off_m=0.0)
    before = rest.answers[-1].covariance[POSITION, POSITION]
    rest.fix(0.7)
    rest.until(1.01)
    assert rest.refused() == {}
    assert np.trace(rest.answers[-1].covariance[POSITION, POSITION]) < np.trace(before)


def test_an_increment_that_no_body_could_make_is_an_outlier() -> None:
    rest = AtRest()
    rest.until(1.0, off_m=0.0, has_lidar=True)
    T = np.eye(4)
    T[0, 3] = 2.0
    rest.smoother.add(Increment(1.0, 1.1, T, 1e-6 * np.eye(6)))
    answer = rest.until(1.2, off_m=0.0)
    assert rest.refused() == {"odometry: outlier": 1}
    assert answer.state.p_map_imu == pytest.approx(Z, abs=1e-2)


def test_a_long_gap_of_samples_begins_a_new_graph_that_is_less_certain() -> None:
    rest = AtRest()
    before = rest.until(1.0, off_m=0.0)
    rest.k += 500
    rest.smoother.add_sample(Inertial(rest.now_s, Z, UP, 5.0))
    answer = rest.until(rest.now_s + 0.5)
    grown = answer.covariance - before.covariance
    # 1 m/s² over five seconds may have moved it by 12.5 m.
    assert np.diag(grown)[POSITION].min() > 12.0**2
    assert answer.mode == Mode.GLOBAL  # no fix could come
    rest.fix(rest.now_s)
    assert rest.until(rest.now_s + 0.5).mode == Mode.GLOBAL


def test_the_second_graph_gives_the_estimate_without_fixes() -> None:
    rest = AtRest(fallback="pseudo_global")
    rest.until(1.0, off_m=0.0, has_lidar=True)
    answer = rest.until(4.0, has_lidar=True)
    assert answer.mode == Mode.FALLBACK
    assert answer.state.p_map_imu == pytest.approx(Z, abs=0.02)
    answer = rest.until(5.2, off_m=0.0, has_lidar=True)
    assert answer.mode == Mode.GLOBAL
    assert answer.state.p_map_imu == pytest.approx(Z, abs=0.02)


@pytest.mark.parametrize("fallback", ["relative", "pseudo_global"])
def test_a_graph_that_has_no_solution_begins_anew_at_the_last_good_estimate(
    monkeypatch: pytest.MonkeyPatch, fallback: str
) -> None:
    rest = AtRest(fallback=fallback)
    rest.until(1.0, off_m=0.0, has_lidar=True)
    before = rest.until(3.0, has_lidar=True)
    assert before.mode == Mode.FALLBACK
    fail_once(monkeypatch)
    count = len(rest.answers)
    rest.until(3.2, has_lidar=True)
    failed = rest.answers[count]
    assert failed.refused == {"smoother: rebuilt": 1}
    assert failed.state.stamp_s == before.state.stamp_s
    assert failed.state.p_map_imu == pytest.approx(before.state.p_map_imu)
    answer = rest.until(4.0, has_lidar=True)
    assert rest.refused()["smoother: rebuilt"] == 1
    assert answer.mode == Mode.FALLBACK
    assert answer.state.stamp_s == 4.0
    assert answer.state.p_map_imu == pytest.approx(Z, abs=0.05)


def test_a_long_gap_during_an_outage_begins_both_graphs_anew() -> None:
    rest = AtRest(fallback="pseudo_global")
    rest.until(1.0, off_m=0.0, has_lidar=True)
    before = rest.until(3.0, has_lidar=True)
    rest.k += 200
    rest.smoother.add_sample(Inertial(rest.now_s, Z, UP, 2.0))
    answer = rest.until(rest.now_s + 0.6, has_lidar=True)
    assert answer.mode == Mode.FALLBACK
    assert answer.state.stamp_s == pytest.approx(rest.now_s)
    grown = answer.covariance - before.covariance
    assert np.diag(grown)[POSITION].min() > 1.9**2  # 1 m/s² over two seconds


def test_a_fix_that_disagrees_with_those_before_it_ends_the_recovery() -> None:
    rest = AtRest()
    rest.until(1.0, off_m=0.0, has_lidar=True)
    rest.until(3.0, has_lidar=True)
    rest.until(3.4, off_m=0.0, has_lidar=True)
    assert rest.modes()[-1] == (Mode.RECOVERING, "left is back")
    rest.until(3.6, off_m=8.0, has_lidar=True)
    assert rest.modes()[-1] == (Mode.FALLBACK, "left disagrees with those before it")
    assert rest.refused()["left: during recovery"] == 3


@pytest.mark.parametrize(
    ("after_s", "modes"),
    [
        (0.5, []),  # not longer than it may be silent
        (0.50390625, [Mode.SUSPECT]),
        (1.0, [Mode.SUSPECT]),
        (1.00390625, [Mode.SUSPECT, Mode.FALLBACK]),
    ],
)
def test_silence_is_told_once_it_is_longer_than_allowed(after_s: float, modes: list[Mode]) -> None:
    """Times are multiples of 2⁻⁸ s, which numbers of the computer hold exactly."""
    rest = AtRest(suspect_after_s=0.5, fallback_after_s=1.0)
    smoother = rest.smoother
    smoother._fixes.used_s = 2.0
    for now_s in (2.25, min(2.0 + after_s, 2.75), 2.0 + after_s):
        smoother._watch_silence(now_s)
    assert [change.after for change in smoother._modes.changes] == modes


@pytest.mark.parametrize("after_gap", [False, True])
def test_a_first_solution_that_fails_leaves_the_first_state(
    monkeypatch: pytest.MonkeyPatch, after_gap: bool
) -> None:
    """Also that from which it began anew after a long gap of the samples."""
    rest = AtRest()
    if after_gap:
        rest.until(1.0, off_m=0.0)
        rest.k += 200
        rest.smoother.add_sample(Inertial(rest.now_s, Z, UP, 2.0))
    fail_once(monkeypatch)
    began_s, count = rest.now_s, len(rest.answers)
    rest.until(began_s + 1.5)
    failed = rest.answers[count]
    assert failed.refused["smoother: rebuilt"] == 1
    assert failed.state.stamp_s == pytest.approx(began_s)
    assert failed.state.p_map_imu == pytest.approx(Z, abs=0.2)
    assert rest.answers[-1].state.stamp_s > began_s
