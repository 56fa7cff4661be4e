"""What the benchmarks share: a miss ends with 1, wrong input with 2; no bound is no benchmark."""

import argparse
import importlib
import json
from pathlib import Path
from types import ModuleType
from typing import get_args

import numpy as np
import pytest
from executive_plugins.physics.scenario import Scenario

BENCHMARKS = Path(__file__).parent / "benchmarks"


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module


@pytest.fixture
def bounds(load) -> ModuleType:
    return load("bounds")


PEERS = {"pybullet"}  # compared with where they are installed, and no dependency


def test_a_miss_ends_with_1_and_is_repeated_on_standard_error(bounds, capsys) -> None:
    figures = [
        bounds.held("error [cm]", 1.2, bounds.Bound(1.0)),
        bounds.held("replay", 60, bounds.Bound(50, is_least=True)),
    ]
    assert bounds.verdict(figures) == 1
    out, err = capsys.readouterr()
    assert "| error [cm] | **1.2** | ≤ 1 | **missed** |" in out
    assert "| replay | 60 | ≥ 50 | met |" in out
    assert err == "missed: error [cm]: 1.2, must be ≤ 1\n"


def test_all_met_ends_with_0(bounds, capsys) -> None:
    assert bounds.verdict([bounds.judged("stones", "7 of 7", "all", True)]) == 0
    assert capsys.readouterr().err == ""


def test_no_bound_at_all_is_refused(bounds) -> None:
    with pytest.raises(ValueError, match="could not fail"):
        bounds.verdict([bounds.Figure("drift", "3 mm")])
    with pytest.raises(ValueError, match="could not fail"):
        bounds.verdict([])


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_was_not_measured_misses(bounds, value: float) -> None:
    assert bounds.held("error", value, bounds.Bound(1.0)).is_missed


@pytest.mark.parametrize(
    ("value", "is_least", "verdict"),
    [
        (0.5, False, "stretch"),
        (0.7, False, "met"),
        (1.0, False, "met"),
        (1.0 + 1e-12, False, "met"),
        (1.001, False, "missed"),
        (0.5, True, "missed"),
        (1.0, True, "stretch"),
        (1.5, True, "stretch"),
    ],
)
def test_bounds_include_their_limit(bounds, value, is_least, verdict) -> None:
    bound = bounds.Bound(1.0, 1.0 if is_least else 0.5, is_least)
    assert bounds.held("figure", value, bound).verdict == verdict


def test_seeds_are_read_with_their_last_one(bounds) -> None:
    assert bounds.numbers("3") == [3]
    assert bounds.numbers("1:4") == [1, 2, 3, 4]


@pytest.mark.parametrize("text", ["", "x", "4:1", "1:2:3", "-1", "1.5"])
def test_a_wrong_seed_is_refused_with_the_right_form(bounds, text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="write 3, or 1:10"):
        bounds.numbers(text)


def ended(command: ModuleType, words: list[str]) -> int:
    """Return the exit status of a benchmark."""
    try:
        return command.main(words)
    except SystemExit as end:
        return int(end.code or 0)


def test_perception_figures_judge_the_file_that_they_are_given(load, tmp_path, capsys) -> None:
    command = load("perception_figures")
    kept = tmp_path / "figures.json"
    words = ["--print", "--figures", str(kept)]
    assert ended(command, words) == 2
    good = {"same_bits": {"scenes": 10, "same_again": 10, "same_over_threads": 10}}
    kept.write_text(json.dumps(good))
    assert ended(command, words) == 0
    good["same_bits"]["same_again"] = 9
    kept.write_text(json.dumps(good))
    assert ended(command, words) == 1
    assert "missed: same seed, same bits" in capsys.readouterr().err


def attempts(placed: int, stones: int, ranking: str, scenario: str) -> list[dict]:
    """Make up rows of a benchmark of grasps, the first of them placed at the first attempt."""
    good = {"outcome": "placed", "lifted": True, "dropped": False}
    bad = good | {"outcome": "slip"}
    return [
        {"stones": "generated", "ranking": ranking, "weights": "", "site": 1, "stone": i}
        | {"found": True, "set_aside": None, "flatness": 0.8}
        | {"scale": 1.0, "scenario": scenario}
        | {"attempts": [good] if i < placed else [bad, good]}
        for i in range(stones)
    ]


@pytest.mark.parametrize(
    ("placed", "paper", "scenario", "status"),
    [
        (95, 70, "nominal", 0),
        (89, 70, "nominal", 1),
        (95, 90, "nominal", 1),
        (76, 60, "wet", 0),
        (74, 60, "harsh", 1),
    ],
)
def test_grasps_are_held_to_their_share_and_to_the_paper(
    load, tmp_path, placed: int, paper: int, scenario: str, status: int
) -> None:
    command = load("grasp_attempts")
    assert ended(command, [str(tmp_path), "table"]) == 2
    rows = [
        *attempts(placed, 100, "learned", scenario),
        *attempts(paper, 100, "paper", scenario),
    ]
    (tmp_path / "attempts.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert ended(command, [str(tmp_path), "table"]) == status


@pytest.mark.parametrize(
    ("drift_m", "worse_m", "late_ms", "status"),
    [(0.009, 0.1, 50, 0), (0.011, 0.0, 50, 1), (0.009, 0.0, 61, 1)],
)
def test_maps_are_held_to_drift_and_time(
    load, bounds, monkeypatch, drift_m: float, worse_m: float, late_ms: float, status: int
) -> None:
    """Drift has no bound where measurements were made worse."""
    trial = load("trials.mapping")
    told = {("filter", "map"): (drift_m, 30.0, late_ms), ("filter, outage", "map"): (worse_m, 1, 1)}
    monkeypatch.setattr(trial, "recorded", lambda seed: (seed, None))
    monkeypatch.setattr(trial, "replayed", lambda ticks, track, seed: (seed, None))
    monkeypatch.setattr(trial, "measured", lambda everyone, true: told.items())
    assert bounds.verdict(trial.swings([1, 2])) == status


@pytest.mark.parametrize(
    ("worst_bias_m", "std_m", "map_m", "drives", "status"),
    [
        (0.0017, 0.012, 0.0017, False, 0),
        (0.0019, 0.012, 0.0017, True, 1),
        (0.0017, 0.013, 0.0017, False, 1),
        (0.0017, 0.012, 0.0019, False, 1),
    ],
)
def test_estimates_of_missions_are_held_to_the_worst_of_all(
    load,
    monkeypatch,
    capsys,
    worst_bias_m: float,
    std_m: float,
    map_m: float,
    drives: bool,
    status: int,
) -> None:
    """The mission and its machine are those that the command line asks for."""
    trial, runs = load("trials.mission_estimates"), []

    def recorded(mission, settings, seed, folder):
        runs.append((Path(mission).stem, tuple(settings), seed))
        (folder / "run").mkdir()
        on_map = {"distance_m": {"median": 0.02, "p95": 0.1}, "bias_m": -map_m, "std_m": std_m}
        truth = {"map": on_map}
        (folder / "run" / "report.json").write_text(json.dumps({"truth": truth}))
        return seed

    def compared(seed, estimators, options):
        error_m = {"bias": worst_bias_m / seed, "component_std": std_m}
        return {estimators[0]: {"truth": {"error_m": error_m}, "duration_s": 30.0}}

    monkeypatch.setattr(trial, "record_mission", recorded)
    monkeypatch.setattr(trial, "compare_on", compared)
    words = ["1:2", *["--drive"] * drives]
    assert ended(load("mission_estimates"), words) == status
    mission = "drive_and_scan" if drives else "map_site"
    assert runs == [(mission, (), 1), (mission, (), 2)]
    assert f"({50 * worst_bias_m:.2f} to {100 * worst_bias_m:.2f})" in capsys.readouterr().out


def test_the_scenarios_that_a_command_line_knows_are_those_that_there_are(load) -> None:
    assert set(load("estimation_faults").SCENARIOS) == set(load("scenarios.scenario").SCENARIOS)
    assert set(load("grasp_sites").RANKINGS) == set(load("trials.grasp_rows").RANKINGS)
    assert set(load("grasp_sites").SCENARIOS) == set(get_args(Scenario))
    assert set(load("perception_figures").PARTS) == set(load("trials.perception_figures").PARTS)


def test_what_the_benchmarks_import_is_there(load) -> None:
    missing = set()
    for path in sorted((BENCHMARKS / "trials").glob("*.py")):
        try:
            load(f"trials.{path.stem}")
        except ModuleNotFoundError as error:
            missing.add(error.name)
    assert missing <= PEERS


def test_what_is_no_log_ends_with_2(load, tmp_path, capsys) -> None:
    assert ended(load("drive_log"), [str(tmp_path / "none.mcap")]) == 2
    (tmp_path / "broken.mcap").write_bytes(b"no log")
    assert ended(load("drive_log"), [str(tmp_path / "broken.mcap")]) == 2
    assert "broken.mcap" in capsys.readouterr().err


def test_a_trial_of_mappers_takes_observations_as_a_mission_does(load) -> None:
    trial = load("trials.mapping_trials")
    one = trial.trial("truth", trial.TrueState(), ["voxel_map"], trial.as_it_is)
    one.process([object()])
    assert len(one.fan.cloud().points) == 0
