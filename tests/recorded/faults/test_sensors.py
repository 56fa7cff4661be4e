"""What arrives of sensors with each kind of fault, of one seed and of another."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from executive.faults.description import SensorFault
from executive.faults.timing import Schedule, Timing

CASES = runpy.run_path(str(Path(__file__).parents[2] / "faults" / "test_sensor_faults.py"))
HOWS = SensorFault.model_fields["how"].annotation.__args__
SENSORS = ("imu_cabin", "imu", "gnss_left", "lidar_vertical", "encoders", "efforts")
GIVEN = {"offset": 0.25, "delay": 0.12, "rate": 3.0, "share": 0.4, "jump": -0.3}


def shown(one) -> list:
    """Return a sample as its stamp and the sums of its values, which chance may have changed."""
    names = ("angular_velocity_rad_s", "specific_force_m_s2", "geodetic", "position", "velocity")
    values = [getattr(one, name, None) for name in (*names, "effort", "points_lidar")]
    found = [np.asarray(value, dtype=float).ravel() for value in values if value is not None]
    kind = getattr(one, "frame", None) or getattr(one, "antenna", None) or "encoders"
    whole = np.concatenate(found)
    return [kind, len(whole), one.stamp_s, *(float(v) for v in (whole @ np.arange(len(whole)),))]


def arrived(**fault) -> list:
    ticks, events, injector = CASES["run"](until_s=0.8, **fault)
    told = [[round(at_s, 6), *map(shown, found)] for at_s, found in ticks]
    of_kind: dict[str, list] = {}
    for at_s, *found in told:
        for kind, count, stamp_s, value in found:
            of_kind.setdefault(kind, []).append([at_s, count, stamp_s, value])
    table = np.concatenate([np.array(of_kind[kind]) for kind in sorted(of_kind)])
    named = [(type(event).__name__, getattr(event, "acted", None)) for event in events]
    return [table, named, [(one.acted, one.spans) for one in injector._armed]]


@pytest.mark.parametrize("how", HOWS)
def test_each_fault(recorded, how) -> None:
    told = {}
    for sensor in SENSORS:
        for name in ("", *GIVEN):
            given = {name: GIVEN[name]} if name else {}
            words = {"sensor": sensor, "how": how, "at": 0.2, "lasts": 0.35, **given}
            try:
                SensorFault(**words)
            except ValidationError as error:
                told[f"{sensor} {name}"] = error.errors()[0]["msg"][:60]
                continue
            told[f"{sensor} {name}"] = arrived(**words)
    recorded(told)


@pytest.mark.parametrize("seed", [1, 2])
def test_chance(recorded, seed) -> None:
    recorded(arrived(seed=seed, sensor="imu_cabin", how="garbage", chance=0.99, lasts=0.1))


def test_schedules(recorded) -> None:
    told = []
    for timing in (
        Timing(at=0.3),
        Timing(at=0.3, lasts=0.4),
        Timing(node="Scan"),
        Timing(node="Scan", nth=2, after=0.2, lasts=0.1),
        Timing(chance=0.9, lasts=0.3),
        Timing(chance=0.2),
    ):
        schedule = Schedule(timing, np.random.default_rng(3))
        for k in range(40):
            if k in (4, 9, 13):
                schedule.node_started("main/0:Scan" if k != 9 else "main/1:Scanner", k / 10)
            told.append(schedule.is_active(k / 10))
    recorded("".join("x" if one else "." for one in told))
    for wrong in ({}, {"at": 1.0, "node": "a"}, {"at": 1.0, "nth": 2}, {"chance": 0.5, "after": 1}):
        with pytest.raises(ValidationError) as refused:
            Timing(**wrong)
        recorded(refused.value.errors()[0]["msg"])
