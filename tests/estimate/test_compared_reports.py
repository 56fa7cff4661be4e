"""Estimators side by side, recovery after an outage, and how plugins of a log are made."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from executive import registry
from executive.config import NoSettings
from executive.errors import ConfigError
from executive.estimate import calibrate, compare, estimator_run
from executive.estimate.calibrate import calibrated
from executive.estimate.compare import reported, table
from executive.estimate.plugin_making import made
from executive.interfaces.plugin import Plugin


def figures(mean: float, n: int = 5, **more: float) -> dict[str, float]:
    return {"n": n, "mean": mean, "std": mean / 10, "p95": 2 * mean, "p99": 3 * mean, **more}


def outage(**fields: Any) -> dict[str, Any]:
    known = {"from_s": 10.0, "to_s": 20.4, "way_m": 12.6, "error_at_end_m": 0.5,
             "max_error_m": 0.75, "recovered_after_s": 1.25}  # fmt: skip
    return known | fields


def report(scale: float = 1.0, **fields: Any) -> dict[str, Any]:
    return {
        "prediction_m": figures(0.02 * scale),
        "posterior_m": figures(0.01 * scale),
        "consistency_m": figures(0.03, n=0),
        "latency_us": figures(12.0),
        "odometry_step_m": 0.0123,
        "replay_speed": 41.6,
        "outages": [outage()],
        "truth": {},
    } | fields


def cells(text: str, title: str) -> list[str]:
    """Return the cells of a row; columns are two spaces or more apart."""
    (line,) = (line for line in text.splitlines() if line.startswith(title))
    return [one.strip() for one in line.removeprefix(title).split("  ") if one.strip()]


def test_errors_are_in_centimetres_and_latencies_in_microseconds() -> None:
    text = table({"one": report(), "other": report(2.0)})
    assert cells(text, "position error of the prediction [cm]") == ["2.00 ± 0.20", "4.00 ± 0.40"]
    assert cells(text, "  95 % [cm]") == ["4.00", "8.00"]
    assert cells(text, "position error after the fix [cm]") == ["1.00 ± 0.10", "2.00 ± 0.20"]
    assert cells(text, "consistency [cm]") == ["-", "-"]
    assert cells(text, "latency of an inertial sample [µs]") == ["12.00 ± 1.20"] * 2
    assert cells(text, "  99 % [µs]") == ["36.00"] * 2
    assert cells(text, "largest step of the odometry frame [cm]") == ["1.23"] * 2
    assert cells(text, "replay, times real time") == ["42"] * 2
    assert "truth" not in text
    assert len({len(line) for line in text.splitlines()[:9]}) == 1  # to the right


def test_each_outage_has_its_errors_and_its_recovery() -> None:
    never = report(outages=[outage(recovered_after_s=None), outage()])
    text = table({"one": report(), "other": never})
    assert text.count("outage 10–20 s, distance travelled 13 m:") == 1  # the one that both have
    assert cells(text, "  at its end, against the fixes [m]") == ["0.50", "0.50"]
    assert cells(text, "  largest [m]") == ["0.75", "0.75"]
    assert cells(text, "  GLOBAL again after [s]") == ["1.25", "-"]


def true(bias: bool = True) -> dict[str, Any]:
    error = {"mean": 0.04, "std": 0.01, "max": 0.09}
    if bias:
        error |= {"bias": 0.02, "component_std": 0.015}
    return {"error_m": error, "error_rad": {"mean": 0.003, "std": 0.001}}


def test_against_a_simulators_truth_the_errors_come_first() -> None:
    seen = [outage(truth={"max": 0.1234})]
    both = {"one": report(truth=true(), outages=seen), "other": report(truth=true(False))}
    text = table(both)
    assert text.splitlines()[1].startswith("position error against the truth [cm]")
    assert cells(text, "position error against the truth [cm]") == ["4.00 ± 1.00"] * 2
    assert cells(text, "  as bias ± std of a component") == ["2.00 ± 1.50", "-"]
    assert cells(text, "  largest [cm]") == ["9.00"] * 2
    assert cells(text, "attitude error against the truth [mrad]") == ["3.00 ± 1.00"] * 2
    assert "largest, against the truth [m]" not in text  # one of them lacks it
    text = table({"one": both["one"], "other": both["one"]})
    lines = text.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("  largest, against the truth"))
    assert lines[at].split()[-2:] == ["0.123", "0.123"]
    assert lines[at - 1].startswith("  largest [m]")


def states(*found: tuple[float, str]) -> list[dict[str, Any]]:
    return [{"time_s": time_s, "status": status} for time_s, status in found]


@pytest.mark.parametrize(
    ("found", "recovered_s"),
    [
        (states((0.0, "GLOBAL")), 0.0),
        (states((0.0, "GLOBAL"), (12.0, "LOCAL"), (21.6, "GLOBAL"), (30.0, "GLOBAL")), 1.2),
        (states((0.0, "GLOBAL"), (12.0, "LOCAL")), None),
        (states((0.0, "GLOBAL"), (12.0, "LOCAL"), (20.4, "GLOBAL")), 0.0),
        (states((25.0, "GLOBAL")), 4.6),
    ],
)
def test_the_time_until_it_is_global_again_counts_from_the_end_of_the_outage(
    monkeypatch: pytest.MonkeyPatch, found: list[dict[str, Any]], recovered_s: float | None
) -> None:
    monkeypatch.setattr(compare, "odometry_steps", lambda track: np.array([0.0012345, 0.001]))
    asked: list[list[float]] = []

    def truth(some: Any) -> dict[str, Any]:
        asked.append([one.stamp_s for one in some])
        return {"error_m": {"max": 0.5}}

    replayed = [SimpleNamespace(stamp_s=t) for t in (9.9, 10.0, 15.0, 20.3, 20.4)]
    estimated: Any = SimpleNamespace(
        report={"states": found, "outages": [outage()]},
        track=None,
        replay=SimpleNamespace(states=replayed),
    )
    got = reported(estimated, truth)
    assert got["odometry_step_m"] == 0.00123
    assert got["outages"][0]["recovered_after_s"] == recovered_s
    assert got["outages"][0]["truth"] == {"max": 0.5}
    assert asked == [[10.0, 15.0, 20.3], [9.9, 10.0, 15.0, 20.3, 20.4]]
    without = reported(estimated)
    assert without["truth"] == {}
    assert "truth" not in without["outages"][0]


def test_each_estimator_runs_over_the_same_log(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[Any, ...]] = []

    def estimate(*given: Any) -> Any:
        asked.append(given)
        return given[1]

    monkeypatch.setattr(compare, "estimate", estimate)
    monkeypatch.setattr(compare, "reported", lambda one, truth: {"of": one, "truth": truth})
    material: Any = "log"
    options: Any = "options"
    found = compare.compare(material, ["a", "b"], options)
    assert found == {"a": {"of": "a", "truth": None}, "b": {"of": "b", "truth": None}}
    assert asked == [("log", "a", "options"), ("log", "b", "options")]


def test_a_calibrator_is_closed_whatever_becomes_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[Any] = []

    def solve(observations: Any) -> Any:
        done.append(list(observations))
        if not done[-1]:
            raise ValueError("no motion")
        return ["clock"]

    plugin = SimpleNamespace(
        start=lambda: done.append("start"), close=lambda: done.append("close"), calibrate=solve
    )
    monkeypatch.setattr(calibrate, "prepare", lambda *given: plugin)
    material: Any = SimpleNamespace(arrivals=[SimpleNamespace(observation="a")])
    assert calibrated(material, "any") == ["clock"]
    assert done == ["start", ["a"], "close"]
    done.clear()
    empty: Any = SimpleNamespace(arrivals=[])
    with pytest.raises(ValueError, match="no motion"):
        calibrated(empty, "any")
    assert done == ["start", [], "close"]


class Made(Plugin):
    """Keeps what it is given."""

    def __init__(self, settings: Any, **given: Any) -> None:
        self.given = given


def test_a_plugin_of_a_log_is_given_the_rig_and_the_same_random_numbers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig: Any = "rig"
    monkeypatch.setattr(registry, "dependencies_of", lambda plugin: ("machine", "rng"))
    one, other = made(Made, NoSettings(), rig), made(Made, NoSettings(), rig)
    assert one.given["machine"] == "rig"
    assert one.given["rng"].random() == other.given["rng"].random()
    assert one.given["rng"].random() == np.random.default_rng(1).random(2)[1]
    monkeypatch.setattr(registry, "dependencies_of", lambda plugin: ("alignment", "rng", "moon"))
    with pytest.raises(ConfigError, match="Made needs alignment, moon, which a log does not prov"):
        made(Made, NoSettings(), rig)


def test_a_plugin_that_takes_no_log_is_refused() -> None:
    choices: Any = SimpleNamespace(plugin=lambda capability, name: Made)
    material: Any = None
    told = "estimation plugin 'odd' does not run on recorded logs"
    with pytest.raises(ConfigError, match=told):
        estimator_run.prepare(material, "estimation", "odd", choices)
