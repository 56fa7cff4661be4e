"""The rounds of a calibration: which fixes they take, and when they end."""

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.calibration import keyframe_batch
from executive_plugins.estimation.calibration.keyframe_batch import KeyframeBatch
from executive_plugins.estimation.calibration.keyframe_problem import Solved, Unknowns
from executive_plugins.estimation.calibration.settings import KeyframeBatchSettings
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer

from executive.errors import DataError
from executive.interfaces.recorded_log import RecordedBody

NOISE = InertialNoise(1e-4, 1e-3, 1e-5, 1e-4, 0.1, 9.81, 0.01)


def fix(stamp_s: float, antenna: str = "a") -> Fix:
    return Fix(stamp_s, antenna, np.array([1.0, 2.0, 3.0]), np.zeros(3), np.eye(3))


class Problem:
    """Stands for the least-squares problem: keeps what it is given, answers from a list."""

    given: list[tuple[list[Fix], object, object, object, Unknowns]] = []
    answers: list[tuple[float, float] | None] = []  # changes of a clock [s] with misfits

    def __init__(self, fixes, states, samples, noise, among) -> None:
        self.given.append((fixes, states, samples, noise, among))
        self._among = among

    def solved(self) -> Solved | None:
        answer = self.answers[min(len(self.given), len(self.answers)) - 1]
        if answer is None:
            return None
        states = [f"states {len(self.given)}"]
        zero = np.zeros((3, 3))
        return Solved(self._among, answer[0], zero, zero, answer[1], 50, states)


@pytest.fixture
def problems(monkeypatch):
    """Make the problems answer with changes of a clock and misfits; the last answer stays."""
    monkeypatch.setattr(keyframe_batch, "KeyframeProblem", Problem)

    def answers(*answers: tuple[float, float] | None) -> list:
        monkeypatch.setattr(Problem, "given", [])
        monkeypatch.setattr(Problem, "answers", list(answers))
        return Problem.given

    return answers


def solve(fixes: Sequence[Fix], **settings: object) -> Solved:
    guess = SimpleNamespace(
        fixes=fixes, clock_s=0.02, samples=SampleBuffer(), track=lambda: ["first guess"]
    )
    batch = KeyframeBatch(KeyframeBatchSettings(**settings), SimpleNamespace())
    return batch._solved(guess, NOISE)


EVERY_TENTH = [fix(round(k / 10, 6), name) for k in range(101) for name in ("a", "b")]


def test_a_tenth_of_the_keyframes_comes_first(problems) -> None:
    given = problems((0.0, 1.0))
    solve(EVERY_TENTH, keyframes=100)
    (coarse, begin, _, noise, among), (fine, states, _, _, _) = given
    stamps = [[one.stamp_s for one in fixes if one.antenna == "a"] for fixes in (coarse, fine)]
    assert stamps == [[float(k) for k in range(11)], [round(k / 10, 6) for k in range(101)]]
    assert [one.antenna for one in coarse[:4]] == ["a", "b", "a", "b"]
    assert (begin, states) == (["first guess"], ["states 1"])
    assert noise is NOISE
    assert list(among.arms_imu) == list(among.declared_imu) == ["a", "b"]
    assert (among.arm_std_m, among.clock_std_s) == (0.3, 0.15)
    (receiver,) = among.receivers  # both antennas bear the same stamps
    assert (receiver.antennas, receiver.late_s, receiver.scale) == (("a", "b"), 0.02, 1.0)


def test_fixes_nearer_than_their_errors_are_alike_are_left_out(problems) -> None:
    """A fix early by a hundredth of the period is taken, and the order of arrival is no matter."""
    given = problems((0.0, 1.0))
    late = [fix(0.0), fix(0.1), fix(0.493), fix(0.2), fix(0.3), fix(0.496), fix(1.01), fix(1.0)]
    solve(late, keyframe_period_s=0.5)
    assert [one.stamp_s for one in given[0][0]] == [0.0, 0.496, 1.0]


@pytest.mark.parametrize(
    ("answers", "rounds"),
    [
        ([(1e-4, 1.0)], 1),
        ([(-0.0, 1.04)], 1),
        ([(3e-4, 1.0), (1e-4, 1.0)], 2),  # the clock moved by more than 0.2 ms
        ([(1e-4, 1.06), (1e-4, 1.0)], 2),  # the scale changed by more than 5 %
        ([(1e-4, 0.94), (1e-4, 1.06), (1e-4, 1.0)], 3),
        ([(0.1, 1.0)], 4),  # it never settles
    ],
)
def test_rounds_go_on_until_clocks_and_scales_stay(problems, answers, rounds) -> None:
    given = problems(*answers)
    solve(EVERY_TENTH[:40])
    last = answers[-1] == (0.1, 1.0)
    assert len(given) == rounds + (4 if last else 1)  # then those with all keyframes
    assert given[-1][1] == [f"states {len(given) - 1}"]


def test_fixes_are_scaled_by_the_misfit_down_to_a_hundredth(problems) -> None:
    given = problems((0.0, 3.0), (0.0, 2.0), (0.0, 1.0), (0.0, 1e-4), (0.0, 1.0))
    solve(EVERY_TENTH[:40])
    assert [one[4].receivers[0].scale for one in given] == [1.0, 3.0, 6.0, 6.0, 0.01]


def test_fixes_that_determine_nothing_are_refused(problems) -> None:
    problems((0.1, 1.0), None)
    with pytest.raises(DataError, match=r"record some minutes with an antenna that sees the sky"):
        solve(EVERY_TENTH[:40])


def test_fixes_that_fit_no_motion_are_refused(problems) -> None:
    problems((0.0, 10_100.0), (0.0, 1.0))
    with pytest.raises(DataError, match=r"err 100 times .* right within 'arm_std_m'"):
        solve(EVERY_TENTH[:40])
    problems((0.0, 9_900.0), (0.0, 1.0))
    solve(EVERY_TENTH[:40])


def test_antennas_of_one_receiver_share_most_stamps(problems) -> None:
    """Half of the stamps are not enough: two receivers may meet by chance."""
    given = problems((0.0, 1.0))
    shared = [fix(t, "b") for t in (0.0, 1.0, 2.5, 3.5)]
    solve([*(fix(float(t), "a") for t in range(4)), *shared])
    assert [one.antennas for one in given[0][4].receivers] == [("a",), ("b",)]
    given = problems((0.0, 1.0))
    solve([*(fix(float(t), "a") for t in range(4)), *shared[:3]])
    assert [one.antennas for one in given[0][4].receivers] == [("a", "b")]


def test_clocks_are_unknown_also_of_a_described_body() -> None:
    body = RecordedBody(("imu_cabin",), (47.0, 8.0, 400.0), is_described=True, clock_std_s=0.01)
    known = KeyframeBatch.settings_for(body)
    assert known == {"imu": "imu_cabin", "datum": (47.0, 8.0, 400.0), "clock_std_s": 0.15}
