"""The swinging cabin of the tests of estimators, and its stream with faults."""

import runpy
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement

_SHARED = runpy.run_path(str(Path(__file__).parents[3] / "plugins" / "estimation" / "conftest.py"))
machine, cabin, with_lidar = (_SHARED[name] for name in ("machine", "cabin", "with_lidar"))
END_S = 3.5


@pytest.fixture
def stream(cabin, with_lidar):
    """Half a second at rest, then a swing; the joints turn with it."""
    cabin.rest_s, cabin.period_s, cabin.swing_rad = 0.8, 3.0, 1.2
    return list(with_lidar(cabin, cabin.observations(END_S)))


@pytest.fixture
def followed():
    """Return the function that runs an estimator over a stream."""
    return _followed


def _followed(estimator, observations) -> object:
    """Return the states now and then, the account, and what was refused."""
    estimator.start()
    states = []
    try:
        for k, observation in enumerate(observations):
            estimator.add(observation)
            if k % 31 == 0:
                states.append(estimator.state())
        return states, estimator.state(), estimator.account(), estimator.refused
    finally:
        estimator.close()


def at(observations, kind, begin_s, end_s, change) -> Iterator[object]:
    """Yield a stream in which the samples of a kind within a time are changed, or left out."""
    for observation in observations:
        stamp_s = getattr(observation, "stamp_s", None) or getattr(observation, "to_s", 0.0)
        if isinstance(observation, kind) and begin_s <= stamp_s < end_s:
            observation = change(observation)
        if observation is not None:
            yield observation


def far_off(fix: GnssFix) -> GnssFix:
    return replace(fix, geodetic=fix.geodetic + [2e-5, -1e-5, 1.0])


def slightly_off(fix: GnssFix) -> GnssFix:
    return replace(fix, geodetic=fix.geodetic + [0.0, 4e-7 * (fix.stamp_s - 1.0), 0.0])


def uncertain(fix: GnssFix) -> GnssFix:
    share = fix.stamp_s % 0.2
    return replace(
        fix,
        covariance_enu_m2=np.diag([1e-4, 0.01 if share < 0.1 else 0.0, 1e-4]),
        is_rtk_fixed=share < 0.15,
    )


def struck(sample: ImuSample) -> ImuSample:
    rate = np.array([0.0, 35.5, 0.0]) if sample.stamp_s % 0.04 < 0.02 else np.zeros(3)
    return replace(sample, angular_velocity_rad_s=rate, specific_force_m_s2=np.full(3, 161.0))


def delayed(observations, kind, begin_s, end_s, by: int) -> Iterator[object]:
    """Yield a stream whose samples of a kind within a time come later by a number of samples."""
    held: list[tuple[int, object]] = []
    for k, observation in enumerate(observations):
        while held and held[0][0] <= k:
            yield held.pop(0)[1]
        if isinstance(observation, kind) and begin_s <= observation.stamp_s < end_s:
            held.append((k + by, observation))
        else:
            yield observation


def gap(observations, begin_s, end_s) -> Iterator[object]:
    return at(observations, ImuSample, begin_s, end_s, lambda sample: None)


SHIFT = np.eye(4)
SHIFT[0, 3] = 0.5
FAULTS = {
    "none": lambda s: s,
    "fixes far off": lambda s: at(s, GnssFix, 1.5, 3.0, far_off),
    "fixes that drift": lambda s: at(s, GnssFix, 1.2, 3.5, slightly_off),
    "no fixes": lambda s: at(s, GnssFix, 1.5, 3.0, lambda fix: None),
    "uncertain fixes": lambda s: at(s, GnssFix, 1.5, 2.5, uncertain),
    "an unknown antenna": lambda s: at(
        s, GnssFix, 1.5, 2.0, lambda fix: replace(fix, antenna="nobody's")
    ),
    "samples beyond the range": lambda s: at(s, ImuSample, 1.5, 1.7, struck),
    "late fixes": lambda s: delayed(s, GnssFix, 1.5, 2.5, 90),
    "a short gap": lambda s: gap(s, 1.5, 1.7),
    "a long gap": lambda s: gap(s, 1.5, 1.9),
    "a gap that starts again": lambda s: gap(s, 1.2, 2.3),
    "no joints": lambda s: at(s, JointSample, 0.0, 1.5, lambda sample: None),
    "a moving chassis": lambda s: at(
        s,
        ImuSample,
        2.0,
        2.6,
        lambda i: replace(i, specific_force_m_s2=i.specific_force_m_s2 + [0.4, 0.0, 0.0]),
    ),
    "wrong increments": lambda s: at(
        s, LidarIncrement, 2.0, 2.6, lambda i: replace(i, T_from_to=i.T_from_to @ SHIFT)
    ),
    "increments with a gap": lambda s: at(s, LidarIncrement, 2.0, 2.5, lambda i: None),
}


@pytest.fixture(params=FAULTS)
def faulty(request, stream):
    """Streams with each of the faults; a test may choose some of them."""
    return FAULTS[request.param](stream)
