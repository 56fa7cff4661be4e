"""Each cloud of a folder is worked on once, and what cannot be used does not end the rest."""

import json
import os

import pytest

from executive.commands.clouds.folder import Batch, each_of
from executive.errors import ConfigError, DataError

ASKED = {"method": "ground"}


@pytest.fixture
def clouds(tmp_path):
    """A folder of three clouds, and a file that is none."""
    folder = tmp_path / "clouds"
    folder.mkdir()
    for name in ("b.ply", "a.PLY", "c.las", "notes.md"):
        (folder / name).write_text("points")
        os.utime(folder / name, (1000.0, 1000.0))
    return folder


class Work:
    """Answers with a number, and refuses the clouds of some names."""

    def __init__(self, *refused):
        self.done, self._refused = [], refused

    def __call__(self, cloud, ply):
        self.done.append((cloud.name, ply.name))
        if cloud.name in self._refused:
            raise DataError("no points")
        return {"stones": len(self.done), "what": "Stein – 1 m²"}

    @property
    def names(self):
        return [name for name, _ in self.done]


def told(capsys):
    return capsys.readouterr().err.splitlines()


def test_each_cloud_gets_an_answer_of_its_own_in_order_of_names(clouds, tmp_path, capsys):
    out, work = tmp_path / "new" / "answers", Work()
    assert each_of(Batch(clouds, out, ASKED, "segments"), work) == 0
    assert work.done == [
        ("a.PLY", "a.PLY.segments.ply"), ("b.ply", "b.ply.segments.ply"),
        ("c.las", "c.las.segments.ply"),
    ]  # fmt: skip
    assert sorted(path.name for path in out.iterdir()) == [
        "a.PLY.json", "b.ply.json", "c.las.json",
    ]  # fmt: skip
    text = (out / "b.ply.json").read_text(encoding="utf-8")
    assert json.loads(text) == {"asked": ASKED, "stones": 2, "what": "Stein – 1 m²"}
    assert "Stein – 1 m²" in text
    assert told(capsys) == [f"{clouds}: 3 of 3 clouds"]


def test_a_cloud_that_cannot_be_used_is_told_and_the_others_are_gone_on_with(
    clouds, tmp_path, capsys
):
    work = Work("a.PLY", "b.ply")
    assert each_of(Batch(clouds, tmp_path / "out", ASKED, "segments"), work) == 1
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["c.las.json"]
    assert told(capsys) == [
        "a.PLY: cannot be used: no points (1 of 3)",
        "b.ply: cannot be used: no points (2 of 3)",
        f"{clouds}: 1 of 3 clouds",
    ]


def test_an_answer_is_kept_while_it_is_newer_than_its_cloud_and_to_the_same_question(
    clouds, tmp_path, capsys
):
    out = tmp_path / "out"
    each_of(Batch(clouds, out, ASKED, "segments"), Work())
    os.utime(out / "a.PLY.json", (1000.0, 1000.0))  # as old as its cloud
    os.utime(out / "b.ply.json", (999.0, 999.0))
    (out / "c.las.json").write_text("{")
    told(capsys)
    again = Work()
    assert each_of(Batch(clouds, out, ASKED, "segments"), again) == 0
    assert again.names == ["b.ply", "c.las"]
    assert told(capsys) == ["a.PLY: done before (1 of 3)", f"{clouds}: 3 of 3 clouds"]
    other = Work()
    each_of(Batch(clouds, out, {"method": "other"}, "segments"), other)
    assert len(other.done) == 3


@pytest.mark.parametrize("text", ["[]", "3", '{"stones": 2}'])
def test_a_file_that_is_no_answer_is_written_anew(clouds, tmp_path, text):
    out = tmp_path / "out"
    each_of(Batch(clouds, out, ASKED, "segments"), Work())
    (out / "a.PLY.json").write_text(text)
    again = Work()
    each_of(Batch(clouds, out, ASKED, "segments"), again)
    assert again.names == ["a.PLY"]


def test_an_answer_is_as_old_as_the_other_files_that_it_was_made_of(clouds, tmp_path, capsys):
    target = tmp_path / "target.ply"
    target.write_text("points")
    os.utime(target, (1000.0, 1000.0))
    batch = Batch(clouds, tmp_path / "out", ASKED, "both", (target,))
    assert each_of(batch, Work()) == 0
    again = Work()
    each_of(batch, again)
    assert again.names == []
    for name in ("a.PLY", "b.ply"):
        os.utime(tmp_path / "out" / f"{name}.json", (1500.0, 1500.0))
    os.utime(target, (2000.0, 2000.0))
    each_of(batch, again)
    assert again.done == [("a.PLY", "a.PLY.both.ply"), ("b.ply", "b.ply.both.ply")]


def test_an_answer_that_is_not_accepted_counts_when_it_is_made_and_when_it_is_found(
    clouds, tmp_path, capsys
):
    batch = Batch(clouds, tmp_path / "out", ASKED, "both")

    def work(cloud, ply):
        return {"accepted": cloud.name != "b.ply"}

    for _ in range(2):
        assert each_of(batch, work) == 1
        assert told(capsys)[-1] == f"{clouds}: 3 of 3 clouds, 1 refused"
    assert json.loads((tmp_path / "out" / "b.ply.json").read_text())["accepted"] is False


def test_what_is_left_of_other_options_is_removed_before_a_cloud_is_worked_on(clouds, tmp_path):
    batch = Batch(clouds, tmp_path / "out", ASKED, "both")
    each_of(batch, Work())
    (tmp_path / "out" / "a.PLY.both.ply").write_text("both clouds")
    each_of(Batch(clouds, tmp_path / "out", {"method": "other"}, "both"), Work("a.PLY"))
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["b.ply.json", "c.las.json"]


def test_answers_go_to_another_folder(clouds, tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    for out in (None, file, clouds / ".." / "clouds"):
        with pytest.raises(ConfigError, match="name another folder for answers"):
            each_of(Batch(clouds, out, ASKED, "segments"), Work())


def test_a_folder_without_a_cloud_is_refused(tmp_path):
    (tmp_path / "notes.md").write_text("")
    with pytest.raises(DataError, match=r"holds no cloud \(.*\.ply"):
        each_of(Batch(tmp_path, tmp_path / "out", ASKED, "segments"), Work())
    assert not (tmp_path / "out").exists()
