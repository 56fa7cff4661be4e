"""The folder of a run: one run writes into it, and a second one is told what to do."""

import os
from pathlib import Path

import pytest

from executive.errors import ConfigError
from executive.mission import run_folder
from executive.mission.run_folder import RunFolder


def test_a_new_folder_is_locked_and_holds_room_for_the_report(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path / "a" / "b", "dry")
    assert folder.path == tmp_path / "a" / "b"
    assert (folder.path / "lock").read_text() == f"{os.getpid()}\n"
    assert (folder.path / "reserve").stat().st_size == run_folder._RESERVE_BYTES > 10_000
    with pytest.raises(ConfigError, match=rf"another run writes into .*\(process {os.getpid()}\)"):
        RunFolder.create(folder.path, "dry")
    folder.give_room()
    folder.give_room()
    assert not (folder.path / "reserve").exists()
    folder.release()
    RunFolder.create(folder.path, "dry").release()


def test_a_folder_with_a_run_is_refused_and_let_go(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path, "dry")
    folder.journal.write_text("")
    folder.release()
    for _ in range(2):  # it is not locked by the refusal
        with pytest.raises(ConfigError, match="holds a run already; give another --run-dir"):
            RunFolder.create(tmp_path, "dry")


@pytest.mark.parametrize(
    "name",
    ["mission.yaml", "map.ply", "report.json", "objects.sqlite", "reserve", "values", "kept"],
)
def test_files_that_no_run_has_written_are_not_written_over(tmp_path: Path, name: str) -> None:
    own = tmp_path / name
    if name in ("values", "kept"):  # folders, which a run removes at its end
        own.mkdir()
    else:
        own.write_text("a person's own work")
    for _ in range(2):  # the refusal leaves nothing behind that makes the folder a run's
        with pytest.raises(ConfigError, match=rf"is no run's folder and holds {name}, which a run"):
            RunFolder.create(tmp_path, "dry")
    assert list(tmp_path.iterdir()) == [own]
    (tmp_path / "lock").write_text("7\n")  # a run that was killed before its journal began
    RunFolder.create(tmp_path, "dry").release()


def test_other_files_may_lie_in_the_folder_of_a_run(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("windy")
    RunFolder.create(tmp_path, "dry").release()


def test_a_folder_that_cannot_be_made_or_written_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match=r"the run folder .*file/run cannot be made: Not a dir"):
        RunFolder.create(tmp_path / "file" / "run", "dry")

    def full(path: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as disk:
        disk.setattr(Path, "write_bytes", full)
        for _ in range(2):
            with pytest.raises(ConfigError, match="run cannot be written: No space left on device"):
                RunFolder.create(tmp_path / "run", "dry")
    RunFolder.create(tmp_path / "run", "dry").release()


def test_without_a_path_each_run_has_a_folder_of_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    first, second = (RunFolder.create(None, "dry") for _ in range(2))
    assert first.path.parent == second.path.parent == Path("runs")
    assert first.path != second.path
    assert first.path.name.startswith("dry-20")
    first.release()
    second.release()


def test_what_is_needed_only_to_go_on_is_removed(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path, "dry")
    for part in (folder.values, folder.kept):
        part.mkdir()
        (part / "a").write_text("")
    folder.report.write_text("{}")
    folder.forget_state()
    folder.forget_state()
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["lock", "report.json", "reserve"]
    folder.release()
