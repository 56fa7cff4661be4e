"""A fix or a revolution that a sensor cannot have measured is refused; one at the limit is not."""

import numpy as np
import pytest

from executive.machine.machine import load_machine
from executive.machine.sensor import Lidar
from executive.messages.gnss import GnssFix
from executive.messages.lidar import LidarScan
from executive.watch.plausible import SIGMAS, fix_refusal, scan_refusal

MACHINE = load_machine("m545")
NAME, LIDAR = next((n, s) for n, s in MACHINE.sensors.items() if isinstance(s, Lidar))
SLACK_M = SIGMAS * LIDAR.range_noise_m


def fix(place=(47.0, 8.0, 440.0), covariance=None):
    covariance = 1e-4 * np.eye(3) if covariance is None else covariance
    return GnssFix(1.0, "gnss_left", np.array(place), covariance, True)


@pytest.mark.parametrize(
    ("place", "is_refused"),
    [
        ((47.0, 8.0, 440.0), False),
        ((-90.0, 360.0, -1e5), False),
        ((90.1, 8.0, 440.0), True),
        ((-90.1, 8.0, 440.0), True),
        ((47.0, 360.1, 440.0), True),
        ((47.0, -360.1, 440.0), True),
        ((47.0, 8.0, 1.01e5), True),
        ((47.0, 8.0, -1.01e5), True),
    ],
)
def test_a_fix_is_near_the_ground(place, is_refused):
    assert ("is no place near the ground" in fix_refusal(fix(place))) is is_refused


@pytest.mark.parametrize("last", [0.0, -1e-4])
def test_the_covariance_of_a_fix_is_positive_definite(last):
    assert fix_refusal(fix(covariance=np.diag([1e-4, 1e-4, last]))) != ""
    assert fix_refusal(fix(covariance=np.diag([1e-4, 1e-4, 1e-9]))) == ""


def scan(ranges, lasts_s=0.01):
    points = np.zeros((len(ranges), 3))
    points[:, 1] = ranges
    return LidarScan(5.0, NAME, points, np.linspace(5.0 - lasts_s, 5.0, len(ranges)))


def among(wrong_m, count):
    """Return a thousand ranges, of which some are wrong."""
    ranges = np.full(1000, np.mean(LIDAR.range_m))
    ranges[:count] = wrong_m
    return ranges


@pytest.mark.parametrize("end", [0, 1])
def test_few_returns_may_be_outside_the_range_of_the_sensor(end):
    outside_m = LIDAR.range_m[end] + (-1, 1)[end] * (SLACK_M + 0.01)
    noisy_m = LIDAR.range_m[end] + (-1, 1)[end] * 0.9 * SLACK_M
    assert scan_refusal(LIDAR, scan(among(outside_m, 10))) == ""
    assert "1 % of its returns are outside" in scan_refusal(LIDAR, scan(among(outside_m, 11)))
    assert scan_refusal(LIDAR, scan(among(noisy_m, 1000))) == ""


def test_a_revolution_lasts_no_longer_than_two():
    two_s = 2 / LIDAR.rate_hz
    assert scan_refusal(LIDAR, scan(among(1.0, 0), 0.99 * two_s)) == ""
    told = scan_refusal(LIDAR, scan(among(1.0, 0), 1.01 * two_s))
    assert told == f"its first return is {1.01 * two_s:.2f} s older than its end"


def test_an_empty_revolution_is_nothing_to_refuse():
    assert scan_refusal(LIDAR, scan(np.zeros(0))) == ""
