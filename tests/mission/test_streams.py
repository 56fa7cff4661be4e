"""The streams hand on what an estimator says of itself, each change once."""

from types import MethodType

import numpy as np
import pytest

from executive.interfaces.estimation import Estimator
from executive.interfaces.plugin import Plugin
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.messages.status_change import StatusChange
from executive.messages.verdict import Verdict
from executive.mission.jobs.call import WrongAnswerError
from executive.mission.jobs.tick_call import observations_of
from executive.mission.streams import StreamListener, Streams


class ToldEstimator(Estimator):
    """Says what it is told to."""

    def __init__(self) -> None:
        self.status, self.changes = "INITIALISING", []
        self.stamp_s = 1.0

    def add_imu(self, sample: ImuSample) -> None: ...

    add_gnss = add_joints = add_odometry = add_imu

    def account(self) -> list[StatusChange]:
        return self.changes

    def state(self) -> BaseState:
        eye = np.eye(4)
        return BaseState(
            self.stamp_s, eye, eye, eye, np.zeros(3), np.zeros(3), np.eye(6), self.status
        )


class Listener(StreamListener):
    """Keeps what the streams hand on."""

    def __init__(self, changes: list[StatusChange]) -> None:
        self.changes, self.unknown, self.errors = changes, [], []

    def take_verdict(self, verdict: Verdict) -> None: ...

    def take_status(self, change: StatusChange) -> None:
        self.changes.append(change)

    def take_error(self, capability: str, plugin: Plugin, error: Exception) -> None:
        self.errors.append((capability, str(error)))

    def take_unknown(self, kind: str) -> None:
        self.unknown.append(kind)


def streamed() -> tuple[ToldEstimator, Streams, list[StatusChange]]:
    estimator, told = ToldEstimator(), []
    return estimator, Streams({"estimation": estimator}, (), Listener(told)), told


def test_each_change_of_the_account_is_told_once_with_its_reason() -> None:
    estimator, streams, told = streamed()
    streams.process([])
    first = StatusChange(0.5, "GLOBAL", "SUSPECT", "no fix for 0.6 s")
    second = StatusChange(0.9, "SUSPECT", "FALLBACK", "no good fix for 1.0 s")
    estimator.changes, estimator.status = [first, second], "FALLBACK"
    streams.process([])
    streams.process([])
    assert told == [first, second]


def test_a_change_that_no_account_mentions_is_told_without_a_reason() -> None:
    estimator, streams, told = streamed()
    estimator.status = "GLOBAL"
    streams.process([])
    streams.process([])
    assert told == [StatusChange(1.0, "INITIALISING", "GLOBAL", "")]


def test_an_odometry_hears_inertia() -> None:
    class Listening:
        heard = 0

        def add_imu(self, sample: ImuSample) -> None:
            self.heard += 1

    odometry = Listening()
    streams = Streams({"estimation": ToldEstimator(), "odometry": odometry}, (), Listener([]))
    streams.process([ImuSample(0.01, "imu_cabin", np.zeros(3), np.zeros(3))])
    assert odometry.heard == 1


def test_observations_that_no_plugin_takes_are_counted_and_told_once() -> None:
    class Photograph:
        stamp_s = 0.5

    listener = Listener([])
    streams = Streams({"estimation": ToldEstimator()}, (), listener)
    streams.process([Photograph(), Photograph()])
    assert streams.ignored == {"Photograph": 2}
    assert listener.unknown == ["Photograph"]


def test_a_plugin_is_handed_the_observations_that_it_takes() -> None:
    class Photograph:
        stamp_s = 0.5

    class Camera(Plugin):
        takes = (Photograph,)
        seen = 0

        def take(self, observation: object) -> None:
            self.seen += 1

    camera, listener = Camera(), Listener([])
    streams = Streams({"estimation": ToldEstimator(), "camera": camera}, (), listener)
    streams.process([Photograph()])
    assert (camera.seen, streams.ignored, listener.unknown) == (1, {}, [])


def test_a_stream_plugin_that_fails_is_used_no_more() -> None:
    class Failing:
        calls = 0

        def add_imu(self, sample: ImuSample) -> None:
            self.calls += 1
            raise ValueError("no scan")

    odometry, listener = Failing(), Listener([])
    streams = Streams({"estimation": ToldEstimator(), "odometry": odometry}, (), listener)
    sample = ImuSample(0.01, "imu_cabin", np.zeros(3), np.zeros(3))
    streams.process([sample, sample])
    assert (odometry.calls, listener.errors) == (1, [("odometry", "no scan")])


SAMPLES: dict[str, Observation] = {
    "add_imu": ImuSample(0.1, "imu", np.zeros(3), np.zeros(3)),
    "add_gnss": GnssFix(0.1, "gnss", np.zeros(3), np.eye(3), True),
    "add_joints": JointSample(0.1, ("A",), *np.zeros((3, 1))),
}


@pytest.mark.parametrize("verb", SAMPLES)
def test_a_verb_that_answers_with_another_type_has_not_taken_its_observation(verb: str) -> None:
    estimator, streams, _ = streamed()
    streams.process(list(SAMPLES.values()))  # the estimator is well

    def wrong(self: ToldEstimator, sample: object) -> dict[str, int]:
        return {}

    wrong.__name__ = verb
    setattr(estimator, verb, MethodType(wrong, estimator))
    with pytest.raises(WrongAnswerError, match=f"'{verb}' of the estimation plugin .* dict"):
        streams.process([SAMPLES[verb]])


def test_a_state_that_holds_a_nan_is_refused() -> None:
    estimator, streams, _ = streamed()
    estimator.stamp_s = float("nan")
    with pytest.raises(WrongAnswerError, match=r"NaN \(stamp_s\)"):
        streams.process([])


def test_a_robot_that_returns_no_sequence_is_refused() -> None:
    class Speechless:
        capability = "robot"

        def read(self, until_s: float) -> None:
            return None

    with pytest.raises(WrongAnswerError, match="NoneType instead of a sequence"):
        observations_of(Speechless(), 1.0)
