"""The streams hand on what an estimator says of itself, each change once."""

import numpy as np

from executive.interfaces.estimation import Estimator
from executive.messages.base_state import BaseState
from executive.messages.imu import ImuSample
from executive.messages.status_change import StatusChange
from executive.mission.streams import Streams


class ToldEstimator(Estimator):
    """Says what it is told to."""

    def __init__(self) -> None:
        self.status, self.changes = "INITIALISING", []

    def add_imu(self, sample: ImuSample) -> None: ...

    add_gnss = add_joints = add_odometry = add_imu

    def account(self) -> list[StatusChange]:
        return self.changes

    def state(self) -> BaseState:
        eye = np.eye(4)
        return BaseState(1.0, eye, eye, eye, np.zeros(3), np.zeros(3), np.eye(6), self.status)


def streamed() -> tuple[ToldEstimator, Streams, list[StatusChange]]:
    estimator, told = ToldEstimator(), []
    return (
        estimator,
        Streams({"estimation": estimator}, (), lambda verdict: None, told.append),
        told,
    )


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
    streams = Streams(
        {"estimation": ToldEstimator(), "odometry": odometry}, (), lambda verdict: None
    )
    streams.process([ImuSample(0.01, "imu_cabin", np.zeros(3), np.zeros(3))])
    assert odometry.heard == 1
