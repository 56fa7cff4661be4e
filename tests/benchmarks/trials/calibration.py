"""Calibration of drawn logs against what was drawn."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from bounds import Bound, Figure, held
from drawn_logs.drawn_log import DrawnLog, draw_log
from drawn_logs.measuring import IMU, LIDAR

from executive import registry
from executive.arrays import Float
from executive.errors import DataError
from executive.estimate.offset import Offset
from executive.interfaces.calibration import Quantity
from executive.interfaces.recorded_log import RecordedBody
from executive.machine.rig import Rig

_CLOCK_S, _ARM_STD_M, _TURN_STD_RAD = 0.2, 0.2, 0.05
# As the rig of a log of an unknown body declares its inertial sensor.
_GUESS = {"rate_hz": 100.0, "gyro_noise_rad_s": 0.03, "accel_noise_m_s2": 0.4}
_KINDS = {  # what is judged, with its bound, in which unit it is told, and how many of it make one
    "stamp_late_s": ("clock", Bound(5.0, 2.0), "ms", 1e3),
    "xyz_m": ("lever arm along an axis", Bound(3.0, 1.0), "cm", 1e2),
    "rpy_rad": ("mounting about an axis", Bound(10.0), "mrad", 1e3),
}
_INSIDE = Bound(0.90, 0.95, is_least=True)  # of two standard deviations of a Gaussian: 0.954


@dataclass(slots=True)
class Trial:
    """One log: errors and standard deviations of what is judged, by the quantity's name."""

    words: str
    refused: str = ""
    quantities: list[tuple[Quantity, Float]] = field(default_factory=list)


def trials(seeds: Sequence[int], duration_s: float, is_told: bool) -> list[Trial]:
    """Calibrate one log a seed."""
    found = []
    for seed in seeds:
        trial = _trial(draw_log(seed, duration_s), seed)
        found.append(trial)
        print(f"{trial.words}{' | ' if trial.refused else ''}{trial.refused}", flush=True)
        for one, error in trial.quantities if is_told else ():
            print(
                f"  {one.sensor} {one.name}: error {np.round(error, 5)} ± {np.round(one.std, 5)} "
                f"{'found' if one.is_found.all() else one.is_found}",
                flush=True,
            )
    return found


def _trial(log: DrawnLog, seed: int) -> Trial:
    rng = np.random.default_rng([seed, 1])
    late_s = {"gnss": rng.uniform(-_CLOCK_S, _CLOCK_S), LIDAR: rng.uniform(-_CLOCK_S, _CLOCK_S)}
    offsets = [Offset(sensor, seconds) for sensor, seconds in late_s.items()]
    observations = []
    for arrival in log.arrivals:
        observation = arrival.observation
        for offset in offsets:
            observation = offset.applied(observation)
        observations.append(observation)
    plugin = registry.load("calibration", "keyframe_batch")
    latitude_deg, longitude_deg, altitude_m = map(float, log.datum)
    body = RecordedBody((IMU,), (latitude_deg, longitude_deg, altitude_m), is_described=False)
    settings = plugin.Settings.model_validate(plugin.settings_for(body))
    trial = Trial(log.words)
    try:
        found = plugin(settings, _misdeclared(log.rig, rng)).calibrate(observations)
    except DataError as error:
        trial.refused = str(error)
        return trial
    truth_s = {LIDAR: late_s[LIDAR]}
    for one in found:
        if one.name == "stamp_late_s":
            true = np.array([truth_s.get(one.sensor, late_s["gnss"] + log.gnss.offset_s)])
        elif one.name in _KINDS:
            true = np.array(getattr(log.rig.sensors[one.sensor], one.name))
        else:
            continue
        trial.quantities.append((one, one.value - true))
    return trial


def _misdeclared(rig: Rig, rng: np.random.Generator) -> Rig:
    sensors = {}
    for name, sensor in rig.sensors.items():
        wrong: dict[str, object] = dict(_GUESS) if sensor.kind == "imu" else {}
        if sensor.kind in ("gnss", "lidar"):
            wrong["xyz_m"] = tuple(np.array(sensor.xyz_m) + rng.normal(0, _ARM_STD_M, 3))
        if sensor.kind == "lidar":
            wrong["rpy_rad"] = tuple(rng.normal(0, _TURN_STD_RAD, 3))
        sensors[name] = type(sensor).model_validate(sensor.model_dump() | wrong)
    return rig.model_copy(update={"sensors": sensors})


def figures(found: Sequence[Trial]) -> list[Figure]:
    """Return the figures of all logs with their bounds."""
    refused = sum(bool(trial.refused) for trial in found)
    return [
        Figure("logs; refused with a reason", f"{len(found)}; {refused}"),
        *(one for name in _KINDS for one in _figures(name, found)),
    ]


def _figures(name: str, found: Sequence[Trial]) -> Iterator[Figure]:
    what, bound, unit, factor = _KINDS[name]
    columns = _columns(name, found)
    is_found, error, std = columns["is_found"].astype(bool), columns["error"], columns["std"]
    right = factor * np.abs(error[is_found])
    p95 = float(np.percentile(right, 95)) if len(right) else float("nan")
    median = float(np.median(right)) if len(right) else float("nan")
    words = f"{median:.2f}, {p95:.2f}, {max(right, default=np.nan):.2f} (n = {len(right)})"
    yield Figure(f"{what}: found of all", f"{int(is_found.sum())} of {len(is_found)}")
    yield held(f"{what}, found: error [{unit}], median, 95 %, largest", p95, bound, words)
    inside = float((np.abs(error) <= 2.0 * std).mean()) if len(error) else float("nan")
    yield held(f"{what}, found or not: within two standard deviations", inside, _INSIDE)


def _columns(name: str, found: Sequence[Trial]) -> Mapping[str, Float]:
    own = [pair for trial in found for pair in trial.quantities if pair[0].name == name]
    return {
        "is_found": np.array([bool(x) for one, _ in own for x in one.is_found]),
        "error": np.array([x for _, error in own for x in error]),
        "std": np.array([x for one, _ in own for x in one.std]),
    }
