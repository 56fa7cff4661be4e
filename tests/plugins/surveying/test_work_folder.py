"""What a survey has finished is kept, belongs to its key, and is whole."""

from pathlib import Path

import numpy as np
import pytest
from executive_plugins.surveying.work_folder import WorkFolder, work_folder

from executive.errors import ConfigError


def never() -> np.ndarray:
    raise AssertionError("made again")


def cut_off(folder: Path, key: str, value: float) -> None:
    """Finish one array and one folder, then fail."""

    def work_on() -> None:
        with work_folder(folder, key) as work:
            work.array("a", lambda: np.full(3, value))
            work.folder("model", lambda part: (part / "points").write_text("7"))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work_on()


def test_what_was_finished_is_there_again(tmp_path: Path) -> None:
    folder = tmp_path / "site.work"
    cut_off(folder, "one", 0.1)
    with work_folder(folder, "one") as work:
        assert work.array("a", never).tolist() == [0.1, 0.1, 0.1]
        assert (work.folder("model", never) / "points").read_text() == "7"  # type: ignore[arg-type]
    assert not folder.exists()


def test_content_of_another_key_is_made_anew(tmp_path: Path) -> None:
    cut_off(tmp_path / "work", "one", 1.0)
    cut_off(tmp_path / "work", "other", 2.0)
    assert np.load(tmp_path / "work" / "a.npy").tolist() == [2, 2, 2]


def test_what_was_begun_and_not_finished_is_made_anew(tmp_path: Path) -> None:
    work = WorkFolder(tmp_path)
    (tmp_path / "a.part").write_bytes(b"torn")
    (tmp_path / "model.part").mkdir()
    (tmp_path / "model.part" / "torn").touch()
    with pytest.raises(ZeroDivisionError):
        work.array("a", lambda: np.full(3, 1 / 0))
    assert not (tmp_path / "a.npy").exists()
    assert work.array("a", lambda: np.ones(3)).sum() == 3
    assert not any(work.folder("model", lambda part: None).iterdir())


def test_a_folder_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "photograph.jpg").touch()
    with (
        pytest.raises(ConfigError, match="no survey's: name a new folder"),
        work_folder(tmp_path, "k"),
    ):
        pass
    assert (tmp_path / "photograph.jpg").exists()


def test_without_a_folder_nothing_stays() -> None:
    with work_folder(None, "one") as work:
        work.array("a", lambda: np.ones(3))
    assert not work.path.exists()


def test_what_is_finished_is_there_and_what_was_cut_off_is_not(tmp_path: Path) -> None:
    def cut(part: Path) -> None:
        raise KeyboardInterrupt

    with work_folder(tmp_path / "work", "one") as work:
        assert not work.has("model")
        with pytest.raises(KeyboardInterrupt):
            work.folder("model", cut)
        assert not work.has("model")
        work.folder("model", lambda part: (part / "points").write_text("7"))
        assert work.has("model")
