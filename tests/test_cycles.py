"""Counting what passed a limit in runs that have ended: it holds, or fails and names the run."""

import importlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

BENCHMARKS = Path(__file__).parent / "benchmarks"
KINDS = ("position", "speed", "effort", "flow", "tipping")


@pytest.fixture
def count(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("cycles").main


def limit(kind: str, share: float = 0.8, times: int = 0) -> dict[str, Any]:
    return {
        "kind": kind,
        "of": "J_BOOM",
        "largest_share": share,
        "at_s": 12.5,
        "times_beyond": times,
        "beyond_s": 0.3 * times,
    }


def write(folder: Path, attempts: int = 3, **changes: Any) -> None:
    """Write the report of a run that passed no limit, but for the changes."""
    truth = {"collisions": [], "ground_contacts": 1, "limits": [limit(kind) for kind in KINDS]}
    report = {"picks": [{"attempts": [{}] * attempts}], "reason": "", "fault": None, "truth": truth}
    for name, value in changes.items():
        part = truth if name in truth else report
        part[name] = value
    folder.mkdir(parents=True)
    (folder / "report.json").write_text(json.dumps(report))


def limits(kind: str, share: float, times: int) -> Sequence[dict[str, Any]]:
    return [limit(one) if one != kind else limit(kind, share, times) for one in KINDS]


def test_runs_that_pass_no_limit_hold(count: Any, tmp_path: Path, capsys: Any) -> None:
    write(tmp_path / "campaign" / "one")
    write(tmp_path / "campaign" / "two", limits=limits("speed", 0.93, 0))
    assert count([str(tmp_path), str(tmp_path / "campaign"), "--cycles", "6"]) == 0
    told = capsys.readouterr().out
    assert "| cycles | 6 in 2 runs |" in told  # each run once
    assert "0 (largest share 0.9300, J_BOOM in two)" in told


def test_too_few_cycles_are_a_miss(count: Any, tmp_path: Path, capsys: Any) -> None:
    write(tmp_path / "one")
    assert count([str(tmp_path), "--cycles", "4"]) == 1
    assert "missed: cycles: 3 in 1 runs" in capsys.readouterr().err


@pytest.mark.parametrize("kind", KINDS)
def test_a_limit_that_was_passed_is_a_miss(
    count: Any, tmp_path: Path, capsys: Any, kind: str
) -> None:
    write(tmp_path / "good")
    write(tmp_path / "bad", limits=limits(kind, 1.07, 2))
    assert count([str(tmp_path), "--cycles", "6"]) == 1
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert f"{kind}: 2, 0.60 s in all (largest share 1.0700, J_BOOM in bad)" in told[0]


def test_a_collision_is_a_miss(count: Any, tmp_path: Path, capsys: Any) -> None:
    met = {"bodies": ["dipper", "stone_2"], "from_s": 8.0, "to_s": 8.1, "max_force_n": 5.0}
    write(tmp_path / "one", collisions=[met])
    assert count([str(tmp_path), "--cycles", "3"]) == 1
    assert "dipper with stone_2 in one at 8.0 s" in capsys.readouterr().err


@pytest.mark.parametrize(
    "changes", [{"truth": None}, {"limits": None}, {"limits": []}, {"collisions": None}]
)
def test_a_run_that_nobody_observed_is_a_miss(
    count: Any, tmp_path: Path, capsys: Any, changes: dict[str, Any]
) -> None:
    write(tmp_path / "blind", **changes)
    assert count([str(tmp_path), "--cycles", "3"]) == 1
    assert "not known: 1; blind" in capsys.readouterr().err


def test_a_machine_that_has_tipped_over_is_a_miss(count: Any, tmp_path: Path, capsys: Any) -> None:
    write(tmp_path / "one", reason="the machine has tipped over at 3.00 s")
    assert count([str(tmp_path), "--cycles", "3"]) == 1
    assert "tipping: 1" in capsys.readouterr().err


def test_folders_without_a_run_are_wrong_input(count: Any, tmp_path: Path) -> None:
    with pytest.raises(SystemExit) as ended:
        count([str(tmp_path)])
    assert ended.value.code == 2
