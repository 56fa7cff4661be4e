"""One estimator over one log, from options to report."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import yaml
from pydantic import ValidationError

from executive import registry
from executive.arrays import Float
from executive.clock import WallClock
from executive.config import Settings
from executive.errors import ConfigError, DataError
from executive.estimate.drop import Drop
from executive.estimate.measures import (
    FixErrors,
    Track,
    consistency,
    fix_errors,
    outages,
    spread,
    statistics,
)
from executive.estimate.offset import Offset
from executive.estimate.replay import Replay, Replayer
from executive.interfaces.estimation import Estimator
from executive.interfaces.odometry import LidarOdometry
from executive.interfaces.plugin import Plugin
from executive.logs.log import Arrival, Log
from executive.logs.topics import Topics
from executive.machine.machine import Machine
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

S = TypeVar("S", bound=Settings)

# On a body that no description knows: an engine shakes it, yet it stands; fixes are as good as they
# say, and twice.
_UNKNOWN_BODY = {
    "rest": {"max_rate_std_rad_s": 0.15},
    "gate": 60.0,
    "smoother": {"gate": {"innovation": 60.0}},
}


@dataclass(frozen=True, slots=True)
class Options:
    """What the command line says besides the log.

    Attributes:
        machine: Name of a machine's description; none for the log's own.
        topics: `KIND=NAME` pairs.
        drops: Outages to make.
        offsets: `SENSOR:SECONDS`, what is added to the stamps of a sensor.
        settings: `KEY=VALUE` pairs for the estimator, dots for nested ones.
        odometry: Name of the lidar odometry for logs that hold scans; empty to leave them alone.
        is_realtime: Whether to feed at the log's own pace.
    """

    machine: str | None = None
    topics: Sequence[str] = ()
    drops: Sequence[str] = ()
    offsets: Sequence[str] = ()
    settings: Sequence[str] = ()
    odometry: str = "scan_to_submap"
    is_realtime: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """A log, read once: what any number of estimators can be run on."""

    log: Log
    rig: Rig
    arrivals: Sequence[Arrival]
    datum: Float
    drops: Sequence[Drop] = field(default=())

    @classmethod
    def read(cls, path: Path, options: Options) -> "Material":
        """Read a log.

        Raises:
            DataError: If the log is wrong, or has no fix; ConfigError: if an option is.
        """
        log = Log(path, _validated(Topics, _nested(options.topics), "--topic"))
        rig = log.rig(options.machine)
        offsets = tuple(map(Offset.parse, options.offsets))
        arrivals = list(
            _without_scans((_moved(arrival, offsets) for arrival in log.arrivals()), options, rig)
        )
        fixes = [a.observation for a in arrivals if isinstance(a.observation, GnssFix)]
        first = next((fix for fix in fixes if fix.is_rtk_fixed), None)
        if first is None:
            raise DataError(
                f"{path}: none of {len(fixes)} fixes is a fixed RTK solution (status "
                "2); nothing to anchor to"
            )
        strangers = sorted({fix.antenna for fix in fixes} - set(rig.sensors))
        if strangers:
            raise DataError(
                f"{path}: {rig.name} has no antenna {', '.join(strangers)}; name the "
                "machine with --machine"
            )
        return cls(
            log, rig, arrivals, np.array(first.geodetic), tuple(map(Drop.parse, options.drops))
        )


@dataclass(frozen=True, slots=True, eq=False)
class Estimated:
    """What came of one estimator on one log, and the reference to hold it against if
    there is one.
    """

    report: dict[str, Any]
    replay: Replay
    track: Track
    errors: FixErrors
    reference: Track | None = None


@dataclass(frozen=True, slots=True)
class Prepared:
    """A plugin that is made for a log, not yet started.

    Attributes:
        plugin: The estimator or smoother.
        imu: Inertial sensor that it follows.
        datum: Origin of its map: latitude, longitude [deg], altitude [m], shape (3,).
    """

    plugin: Any
    imu: str
    datum: Float


def prepare(material: Material, capability: str, name: str, pairs: Sequence[str]) -> Prepared:
    """Make a plugin with the settings that a log asks for, and above those the `KEY=VALUE` pairs.

    Raises:
        ConfigError: If there is no such plugin, or its settings are wrong.
        DataError: If the log has no inertial sample.
    """
    plugin = registry.load(capability, name)
    imu = _main_imu(material, plugin.Settings)
    settings = _validated(
        plugin.Settings, _settings(plugin.Settings, material, imu, pairs), "--set"
    )
    datum = getattr(settings, "datum", None)
    return Prepared(
        _made(plugin, settings, material.rig),
        imu,
        material.datum if datum is None else np.array(datum),
    )


def estimate(material: Material, name: str, options: Options) -> Estimated:
    """Run an estimator over a log.

    Raises:
        ConfigError: If there is no such estimator, or its settings are wrong.
        DataError: If the estimator never came to a state.
    """
    prepared = prepare(material, "estimation", name, options.settings)
    estimator: Estimator = prepared.plugin
    try:
        estimator.start()
        replayer = Replayer(estimator, prepared.imu, material.drops)
        replay = replayer.run(material.arrivals, WallClock() if options.is_realtime else None)
    finally:
        estimator.close()
    if not replay.states:
        refused = ", ".join(f"{reason} ×{n}" for reason, n in replay.refused.items()) or "nothing"
        raise DataError(
            f"{material.log.path}: {name} never came to a state. It needs some seconds "
            "at rest, and with one antenna "
            f"some metres of motion after them. {_last_word(estimator)}Refused: {refused}"
        )
    track = Track.of(replay.states)
    errors = fix_errors(track, replay.fixes, material.rig, prepared.datum, material.drops)
    return Estimated(_report(material, name, replay, track, errors), replay, track, errors)


def _last_word(estimator: Estimator) -> str:
    """Return the last reason that the estimator gave; empty if it gave none."""
    account = estimator.account()
    return f"At {account[-1].stamp_s:.1f} s it {account[-1].reason}. " if account else ""


def _report(
    material: Material, name: str, replay: Replay, track: Track, errors: FixErrors
) -> dict[str, Any]:
    used = ~errors.is_dropped
    duration_s = material.arrivals[-1].arrival_s
    return {
        "log": str(material.log.path),
        "body": material.rig.name,
        "estimator": name,
        "duration_s": round(duration_s, 3),
        "replay_speed": round(duration_s / replay.wall_s, 1),
        "counts": dict(replay.counts),
        "skipped": {topic: asdict(skipped) for topic, skipped in material.log.skipped.items()},
        "refused": replay.refused,
        "states": [{"time_s": round(at_s, 3), "status": status} for at_s, status in replay.changes],
        "latency_us": statistics(np.array(replay.latency_us), 1),
        "consistency_m": statistics(consistency(track)),
        "prediction_m": spread(errors.predicted_m[used]),
        "posterior_m": spread(errors.posterior_m[used]),
        "outages": outages(errors, material.drops),
    }


def _main_imu(material: Material, settings: type[Settings]) -> str:
    """Return the inertial sensor that the estimator follows: its default if the log has it, else
    the log's first.
    """
    frames = list(
        dict.fromkeys(
            a.observation.frame for a in material.arrivals if isinstance(a.observation, ImuSample)
        )
    )
    if not frames:
        raise DataError(f"{material.log.path}: the inertial topic holds no message")
    default = settings.model_fields["imu"].default if "imu" in settings.model_fields else frames[0]
    return default if default in frames else frames[0]


def _settings(
    model: type[Settings], material: Material, imu: str, pairs: Sequence[str]
) -> dict[str, Any]:
    known: dict[str, Any] = {"imu": imu, "datum": tuple(map(float, material.datum))}
    if not isinstance(material.rig, Machine):
        known |= _UNKNOWN_BODY
    return _merged(
        {key: value for key, value in known.items() if key in model.model_fields}, _nested(pairs)
    )


def _made(plugin: type[Plugin], settings: Settings, rig: Rig) -> Any:
    services = {"machine": rig, "rng": np.random.default_rng(1)}
    needed = registry.dependencies_of(plugin)
    missing = [name for name in needed if name not in services]
    if missing:
        raise ConfigError(
            f"{plugin.__name__} needs {', '.join(missing)}, which a log does not give"
        )
    return plugin(settings, **{name: services[name] for name in needed})  # type: ignore[call-arg]


def _without_scans(arrivals: Iterable[Arrival], options: Options, rig: Rig) -> Iterator[Arrival]:
    """Yield a log's arrivals, its lidar scans turned into increments: a hundredth of the memory,
    and once for all.
    """
    odometry = _odometry(options, rig)
    try:
        for arrival in arrivals:
            if not isinstance(arrival.observation, LidarScan):
                yield arrival
            if odometry is None:
                continue
            increment = _followed(odometry, arrival.observation)
            if increment is not None:
                yield Arrival(arrival.arrival_s, increment)
    finally:
        if odometry is not None:
            odometry.close()


def _odometry(options: Options, rig: Rig) -> LidarOdometry | None:
    """Return the odometry, started; it follows the lidar that it does by default, or the rig's
    first.
    """
    lidars = [sensor.name for sensor in rig.sensors_of("lidar")]
    if not options.odometry or not lidars:
        return None
    plugin = registry.load("odometry", options.odometry)
    frame = plugin.Settings.model_fields.get("frame")
    known = {"frame": lidars[0]} if frame is not None and frame.default not in lidars else {}
    odometry: LidarOdometry = _made(plugin, plugin.Settings(**known), rig)
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


def _moved(arrival: Arrival, offsets: Sequence[Offset]) -> Arrival:
    observation = arrival.observation
    for offset in offsets:
        observation = offset.applied(observation)
    return (
        arrival if observation is arrival.observation else Arrival(arrival.arrival_s, observation)
    )


def _nested(pairs: Sequence[str]) -> dict[str, Any]:
    """Read `a.b=1` pairs to `{"a": {"b": 1}}`."""
    tree: dict[str, Any] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        if not equals or not key:
            raise ConfigError(f"'{pair}' is not KEY=VALUE")
        try:
            value = yaml.safe_load(text)
        except yaml.YAMLError:
            raise ConfigError(f"'{pair}': the value cannot be read") from None
        for part in reversed(key.split(".")):
            value = {part: value}
        tree = _merged(tree, value)
    return tree


def _merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    both = dict(below)
    for key, value in above.items():
        old = both.get(key)
        both[key] = (
            _merged(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
        )
    return both


def _validated(model: type[S], values: dict[str, Any], option: str) -> S:
    try:
        return model.model_validate(values)
    except ValidationError as error:
        lines = [f"{option} {'.'.join(map(str, e['loc']))}: {e['msg']}" for e in error.errors()]
        raise ConfigError("\n".join(lines)) from None
