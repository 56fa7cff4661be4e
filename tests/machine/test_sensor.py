"""When a sensor counts as lost: some periods without a good sample, beside its latency."""

from dataclasses import dataclass

import pytest

from executive.machine.machine import load_machine
from executive.machine.sensor import Lidar


@dataclass(frozen=True)
class Case:
    rate_hz: float
    latency_s: float
    age_periods: float
    limit_s: float


@pytest.mark.parametrize(
    "case", [Case(10.0, 0.0, 3.0, 0.3), Case(100.0, 0.02, 5.0, 0.07), Case(0.5, 0.0, 1.0, 2.0)]
)
def test_a_sensor_is_lost_after_its_latency_and_so_many_periods(case: Case) -> None:
    (lidar, *_) = load_machine("m545").sensors_of("lidar")
    assert isinstance(lidar, Lidar)
    changed = lidar.model_copy(
        update={
            "rate_hz": case.rate_hz,
            "latency_s": case.latency_s,
            "age_periods": case.age_periods,
        }
    )
    assert changed.age_limit_s == pytest.approx(case.limit_s)
