"""What missions expected of first attempts, against their truth: it holds, or it is a miss."""

import importlib
import json
from pathlib import Path
from typing import Any

import pytest

BENCHMARKS = Path(__file__).parent / "benchmarks"


@pytest.fixture
def compare(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("predicted_success").main


def write(
    folder: Path, expected: float | None, placed: int, failed: int, off_m: float = 0.1
) -> None:
    """Write the report of a run with stones that the first attempt placed, and others."""
    picks = [
        {
            "object": stone,
            "placed": True,
            "attempts": [{"success": expected, "grasp": {"score": 0.5}}] * (1 + (stone >= placed)),
        }
        for stone in range(placed + failed)
    ]
    stones = [{"held_object": pick["object"], "slot_error_m": off_m} for pick in picks]
    truth = {"scenario": "nominal", "stones": stones}
    folder.mkdir(parents=True)
    (folder / "report.json").write_text(json.dumps({"picks": picks, "truth": truth}))


def test_a_chance_that_comes_true_holds(compare: Any, tmp_path: Path, capsys: Any) -> None:
    write(tmp_path / "one", 0.75, placed=15, failed=5)
    write(tmp_path / "two", 0.95, placed=19, failed=1)
    assert compare([str(tmp_path), "--attempts", "40"]) == 0
    told = capsys.readouterr().out
    assert "0.0%, 85.0% expected and 85.0% placed of 40" in told
    assert "75%: 15 of 20, 95%: 19 of 20" in told
    assert "| nominal: the same error of the score alone | 35.0% |" in told


def test_a_chance_that_is_too_high_is_a_miss(compare: Any, tmp_path: Path, capsys: Any) -> None:
    write(tmp_path / "one", 0.95, placed=15, failed=5)
    assert compare([str(tmp_path), "--attempts", "20"]) == 1
    assert "20.0%, 95.0% expected and 75.0% placed of 20" in capsys.readouterr().err


def test_a_stone_that_is_off_by_the_truth_was_not_placed(
    compare: Any, tmp_path: Path, capsys: Any
) -> None:
    write(tmp_path / "one", 0.95, placed=19, failed=1, off_m=0.5)
    assert compare([str(tmp_path), "--attempts", "20"]) == 1
    assert "95.0% expected and 0.0% placed of 20" in capsys.readouterr().err


def test_runs_that_expected_nothing_and_too_few_are_misses(
    compare: Any, tmp_path: Path, capsys: Any
) -> None:
    write(tmp_path / "one", None, placed=5, failed=0)
    assert compare([str(tmp_path)]) == 1
    told = capsys.readouterr().err
    assert "first attempts of which nothing was expected: 5" in told
    assert "nothing was expected of any" in told
    assert "nominal: first attempts: 5" in told


def test_a_run_without_truth_is_a_miss(compare: Any, tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "report.json").write_text(json.dumps({"picks": [], "truth": None}))
    assert compare([str(tmp_path)]) == 1
    assert "runs without truth" in capsys.readouterr().err


def test_a_folder_without_runs_is_wrong_input(compare: Any, tmp_path: Path) -> None:
    with pytest.raises(SystemExit):
        compare([str(tmp_path)])
