"""An estimator is handed each kind of observation by the verb that takes it."""

import numpy as np
import pytest

from executive.interfaces.estimation import Estimator
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement


class Recording(Estimator):
    """Records which verb was called."""

    def __init__(self):
        self.calls = []

    def add_imu(self, sample):
        self.calls.append(("imu", sample))

    def add_gnss(self, fix):
        self.calls.append(("gnss", fix))

    def add_odometry(self, increment):
        self.calls.append(("odometry", increment))

    def add_joints(self, sample):
        self.calls.append(("joints", sample))

    def state(self):
        raise NotImplementedError


def made(kind):
    """Return a message of a kind without its fields: only its type counts here."""
    return object.__new__(kind)


@pytest.mark.parametrize(
    ("kind", "verb"),
    [
        (ImuSample, "imu"),
        (GnssFix, "gnss"),
        (JointSample, "joints"),
        (LidarIncrement, "odometry"),
    ],
)
def test_each_kind_goes_to_its_own_verb_and_to_no_other(kind, verb):
    estimator, observation = Recording(), made(kind)
    estimator.add(observation)
    ((called, given),) = estimator.calls
    assert called == verb
    assert given is observation


def test_a_scan_goes_to_none_because_odometry_takes_it():
    estimator = Recording()
    estimator.add(LidarScan(0.05, "lidar", np.zeros((1, 3)), np.zeros(1)))
    assert estimator.calls == []
