"""Bulk work hands over what each run leaves, says what failed, and cleans up after itself."""

from pathlib import Path

import pytest

from executive.campaign.execution.folder_lock import FolderLock
from executive.commands.bulk import Where, spread
from executive.errors import ConfigError

pytestmark = pytest.mark.usefixtures("misbehaving")


def test_what_is_done_is_handed_over_with_its_seed(tmp_path: Path) -> None:
    taken: dict[int, bool] = {}

    def take(seed: int, folder: Path) -> None:
        taken[seed] = (folder / "omp").read_text() == "1"

    scratch = tmp_path / "unfinished"
    arguments = {"behaviour": "threads"}
    assert spread("misbehaving", arguments, [4, 7, 9], Where(scratch, jobs=2), take) == 0
    assert taken == {4: True, 7: True, 9: True}
    assert not scratch.exists()


def test_what_failed_is_said_with_its_reason(tmp_path: Path, capsys) -> None:
    arguments = {"behaviour": "raises"}
    assert spread("misbehaving", arguments, [4], Where(tmp_path / "unfinished"), print) == 1
    error = capsys.readouterr().err
    assert "misbehaving, seed 4: crashed: ValueError: the arm is too short" in error


def test_a_folder_in_use_is_refused_and_left_alone(tmp_path: Path) -> None:
    scratch = tmp_path / "unfinished"
    (scratch / "runs").mkdir(parents=True)
    lock = FolderLock(scratch / "campaign.lock")
    with pytest.raises(ConfigError, match="works here already"):
        spread("misbehaving", {}, [4], Where(scratch), print)
    lock.release()
    assert (scratch / "runs").is_dir()


def test_nothing_to_do_is_done(tmp_path: Path) -> None:
    assert spread("misbehaving", {}, [], Where(tmp_path / "unfinished"), print) == 0
