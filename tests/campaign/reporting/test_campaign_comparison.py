"""Two campaigns on the same seeds, compared as the levels of a factor."""

import json
from pathlib import Path
from types import ModuleType

import pytest
from typer.testing import CliRunner

from executive.commands.main import app
from executive.errors import ConfigError


@pytest.fixture
def folders(made_up: ModuleType, tmp_path: Path) -> tuple[Path, Path]:
    for name, seeds, share in (("good", "1:40", 0.95), ("bad", "21:80", 0.2)):
        of = made_up.waiting(tmp_path / name, seeds)
        made_up.write_ledger(tmp_path / name, of, made_up.outcomes(of, share))
    return tmp_path / "good", tmp_path / "bad"


def test_it_is_told_as_worse_on_the_common_seeds(folders: tuple[Path, Path]) -> None:
    done = CliRunner().invoke(app, ["compare", *map(str, folders), "--json"])
    assert done.exit_code == 0, done.output
    found = {one["metric"]: one for one in json.loads(done.stdout)}
    assert found["success"]["pairs"] == 20
    assert found["success"]["verdict"] == "worse"
    text = CliRunner().invoke(app, ["compare", *map(str, folders)]).stdout
    assert text.startswith(f"{folders[1]} against {folders[0]}\n")
    assert "missions that succeed: -" in text


def test_campaigns_without_a_common_seed_are_refused(
    made_up: ModuleType, folders: tuple[Path, Path], tmp_path: Path
) -> None:
    other = tmp_path / "other"
    of = made_up.waiting(other, "500:510")
    made_up.write_ledger(other, of, made_up.outcomes(of))
    done = CliRunner().invoke(app, ["compare", str(folders[0]), str(other)])
    assert isinstance(done.exception, ConfigError)
    assert "no seed was run by both" in str(done.exception)


def test_a_campaign_and_a_run_are_refused(folders: tuple[Path, Path], tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["compare", str(folders[0]), str(tmp_path)])
    assert isinstance(done.exception, ConfigError)
    assert "the other one is not" in str(done.exception)
