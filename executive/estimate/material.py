"""A log that was read once, for any number of estimators to be run on."""

import logging
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.errors import ConfigError, DataError
from executive.estimate.calibration import Calibration
from executive.estimate.drop import Drop
from executive.estimate.lever import read_levers
from executive.estimate.offset import Offset
from executive.estimate.options import EstimateOptions
from executive.estimate.plugin_making import made
from executive.estimate.topic_names import read_topics
from executive.interfaces.odometry import LidarOdometry
from executive.interfaces.recorded_log import RecordedBody
from executive.logs.log import Arrival, Log
from executive.machine.machine import Machine
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement
from executive.tree.choices import Choices

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """A log, its rig and its measurements.

    Attributes:
        log: The log.
        rig: The machine or body that carried the sensors.
        arrivals: The measurements in order of arrival; lidar scans are replaced by increments.
        datum: The first fix with a fixed RTK solution, of any kind if there is none: latitude
            [deg], longitude [deg], altitude [m], shape (3,).
        drops: Outages to simulate.
        calibration: What was applied to the rig and the measurements.
    """

    log: Log
    rig: Rig
    arrivals: Sequence[Arrival]
    datum: Float
    drops: Sequence[Drop] = field(default=())
    calibration: Calibration = field(default_factory=Calibration)

    @classmethod
    def read(cls, path: Path, options: EstimateOptions) -> "Material":
        """Read a log.

        Raises:
            DataError: If the log is damaged or has no fix.
            ConfigError: If an option is wrong.
        """
        log = Log(path, read_topics(options.topics))
        rig = log.rig(options.machine, read_levers(options.levers))
        calibration = options.calibration or Calibration()
        rig = calibration.applied(rig)
        offsets = (*calibration.offsets, *map(Offset.parse, options.offsets))
        scaled = (_scaled(arrival, calibration) for arrival in log.arrivals())
        shifted = (_shifted(arrival, offsets) for arrival in scaled)
        arrivals = list(_without_scans(shifted, options.plugins, rig))
        first = _first_fix(path, rig, arrivals)
        drops = tuple(map(Drop.parse, options.drops))
        return cls(log, rig, arrivals, np.array(first.geodetic), drops, calibration)

    def body(self) -> RecordedBody:
        """Return the description of the log that plugins take their settings from.

        Raises:
            DataError: If the log has no inertial sample.
        """
        samples = (a.observation for a in self.arrivals if isinstance(a.observation, ImuSample))
        imus = tuple(dict.fromkeys(sample.frame for sample in samples))
        if not imus:
            raise DataError(f"{self.log.path}: the inertial topic holds no message")
        latitude_deg, longitude_deg, altitude_m = map(float, self.datum)
        is_described = isinstance(self.rig, Machine)
        datum = (latitude_deg, longitude_deg, altitude_m)
        clock_std_s = self.calibration.clock_std_s(
            {
                one.observation.antenna
                for one in self.arrivals
                if isinstance(one.observation, GnssFix)
            }
        )
        return RecordedBody(imus, datum, is_described, clock_std_s)


def _first_fix(path: Path, rig: Rig, arrivals: Sequence[Arrival]) -> GnssFix:
    """Return the first fix with a fixed RTK solution; the first of any kind if there is none."""
    fixes = [a.observation for a in arrivals if isinstance(a.observation, GnssFix)]
    if not fixes:
        raise DataError(
            f"{path}: the receiver has no fix in the whole log, so that the map has no origin; "
            "record under an open sky"
        )
    first = next((fix for fix in fixes if fix.is_rtk_fixed), None)
    if first is None:
        first = fixes[0]
        _log.warning(
            "%s: none of %d fixes has a fixed RTK solution (status 2): the map's origin is the "
            "first fix, and errors are against fixes that themselves err by %.1f m along an axis; "
            "--score compares with a reference",
            path, len(fixes), _median_std_m(fixes),
        )  # fmt: skip
    strangers = sorted({fix.antenna for fix in fixes} - set(rig.sensors))
    if strangers:
        raise DataError(
            f"{path}: {rig.name} has no antenna {', '.join(strangers)}; name the "
            "machine with --machine"
        )
    return first


def _median_std_m(fixes: Sequence[GnssFix]) -> float:
    """Return the horizontal standard deviation of a fix along an axis, in the median [m]."""
    variances = [np.trace(fix.covariance_enu_m2[:2, :2]) / 2 for fix in fixes]
    return float(np.sqrt(np.median(variances)))


def _without_scans(arrivals: Iterable[Arrival], plugins: Choices, rig: Rig) -> Iterator[Arrival]:
    """Yield a log's arrivals with its lidar scans replaced by increments.

    Increments need a hundredth of the memory, and are the same for every estimator.
    """
    running = _odometry(plugins, rig)
    try:
        for arrival in arrivals:
            if not isinstance(arrival.observation, LidarScan):
                yield arrival
            if running is None:
                continue
            increment = _followed(running, arrival.observation)
            if increment is not None:
                yield Arrival(arrival.arrival_s, increment)
    finally:
        if running is not None:
            running.close()


def _odometry(plugins: Choices, rig: Rig) -> LidarOdometry | None:
    """Return the odometry, started; None if none is asked for or the rig has no lidar."""
    lidars = [sensor.name for sensor in rig.sensors_of("lidar")]
    if not plugins.names("odometry") or not lidars:
        return None
    plugin = plugins.plugin("odometry", plugins.name("odometry"))
    if not issubclass(plugin, LidarOdometry):
        raise ConfigError(f"{plugin.__name__} is no LidarOdometry")
    asked_for = plugin.settings_for(lidars)
    settings = plugins.selection("odometry", known=lambda _: asked_for).settings
    odometry: LidarOdometry = made(plugin, settings, rig)
    odometry.start()
    return odometry


def _followed(
    odometry: LidarOdometry, observation: Observation | LidarIncrement
) -> LidarIncrement | None:
    match observation:
        case LidarScan():
            return odometry.add_scan(observation)
        case ImuSample():
            odometry.add_imu(observation)
        case JointSample():
            odometry.add_joints(observation)
    return None


def _shifted(arrival: Arrival, offsets: Sequence[Offset]) -> Arrival:
    observation = arrival.observation
    for offset in offsets:
        observation = offset.applied(observation)
    is_same = observation is arrival.observation
    return arrival if is_same else Arrival(arrival.arrival_s, observation)


def _scaled(arrival: Arrival, calibration: Calibration) -> Arrival:
    observation = calibration.scaled(arrival.observation)
    is_same = observation is arrival.observation
    return arrival if is_same else Arrival(arrival.arrival_s, observation)
