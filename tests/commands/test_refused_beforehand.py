"""What a command cannot write or show is refused before it reads or computes anything."""

import os
from pathlib import Path

import pytest

from executive import extras
from executive.extras import MissingExtraError
from tests.commands.in_process import executive

CLOUDS = {"register": ("a.ply", "b.ply"), "align": ("a.ply", "b.ply"), "segment": ("a.ply",)}
READ = {**CLOUDS, "changes": ("a.ply", "b.ply")}


@pytest.mark.parametrize("verb", CLOUDS)
def test_a_view_without_a_viewer_is_refused(monkeypatch, capsys, tmp_path, verb):
    monkeypatch.chdir(tmp_path)  # where no cloud is

    def require(who, extra):
        raise MissingExtraError(who, extra, ("rerun-sdk",), "executive")

    monkeypatch.setattr(extras, "require_extra", require)
    assert executive(monkeypatch, verb, *CLOUDS[verb], "--view") == 2
    assert capsys.readouterr().err.startswith("error: --view needs the extra 'viewing'")


@pytest.mark.parametrize("verb", CLOUDS)
@pytest.mark.parametrize("out", ["result.txt", "no_folder/result.ply"])
def test_an_output_that_cannot_be_written_is_refused(monkeypatch, capsys, tmp_path, verb, out):
    monkeypatch.chdir(tmp_path)
    assert executive(monkeypatch, verb, *CLOUDS[verb], "--out", out) == 2
    assert capsys.readouterr().err.startswith(f"error: --out: {out}: name a .ply")


@pytest.mark.parametrize("verb", CLOUDS)
def test_a_copc_file_is_not_promised(monkeypatch, capsys, tmp_path, verb):
    monkeypatch.chdir(tmp_path)
    assert executive(monkeypatch, verb, *CLOUDS[verb], "--out", "Site.COPC.laz") == 2
    told = "error: --out: Site.COPC.laz: COPC is read, not written; write Site.laz, and have"
    assert capsys.readouterr().err.startswith(told)


@pytest.mark.parametrize("verb", CLOUDS)
def test_a_setting_that_does_not_exist_is_refused(monkeypatch, capsys, tmp_path, verb):
    monkeypatch.chdir(tmp_path)
    capability = {"register": "registration", "align": "alignment", "segment": "segmentation"}[verb]
    words = (verb, *CLOUDS[verb], "--set", f"{capability}.plugin=nobody")
    assert executive(monkeypatch, *words) == 2
    assert f"no {capability} plugin 'nobody'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("verb", "out"), [(verb, out) for verb, clouds in READ.items() for out in clouds]
)
def test_a_cloud_that_is_read_is_not_written_over(monkeypatch, capsys, tmp_path, verb, out):
    monkeypatch.chdir(tmp_path)
    for name in READ[verb]:
        Path(name).write_text("the only scan of the day", encoding="utf-8")
    Path("link.ply").symlink_to(out)
    for name in (out, f"./{out}", "link.ply"):
        assert executive(monkeypatch, verb, *READ[verb], "--out", name) == 2
        told = f"error: --out: {Path(name)} is a file that is read; name another file\n"
        assert capsys.readouterr().err == told
    assert Path(out).read_text(encoding="utf-8") == "the only scan of the day"


@pytest.mark.parametrize("verb", READ)
def test_a_folder_is_no_output(monkeypatch, capsys, tmp_path, verb):
    monkeypatch.chdir(tmp_path)
    Path("stones.ply").mkdir()
    assert executive(monkeypatch, verb, *READ[verb], "--out", "stones.ply") == 2
    assert capsys.readouterr().err == "error: --out: stones.ply is a folder; name a file\n"


@pytest.mark.parametrize("verb", READ)
def test_an_output_without_permission_is_refused(monkeypatch, capsys, tmp_path, verb):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # root may write everywhere
    assert executive(monkeypatch, verb, *READ[verb], "--out", "stones.ply") == 2
    told = "error: --out: stones.ply cannot be written: permission denied\n"
    assert capsys.readouterr().err == told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--out", "run.mcap"), "--out: run.mcap is a file that is read"),
        (("--out", "a.tum", "--export", "run.mcap"), "--export: run.mcap is a file that is read"),
        (("--out", "true.tum", "--score", "true.tum"), "--out: true.tum is a file that is read"),
        (("--out", "true.x", "--score", "true.json"), "--out: true.json is a file that is read"),
        (("--out", "none/a.tum"), "--out: none/a.tum: name a file in a folder that exists"),
        (("--out", "a.csv", "--export", "a.csv"), "--export a.csv: another file of this command"),
    ],
)
def test_files_of_an_estimate_are_refused_beforehand(monkeypatch, capsys, tmp_path, words, told):
    monkeypatch.chdir(tmp_path)
    for name in ("run.mcap", "true.tum", "true.json"):
        Path(name).write_text("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n", encoding="utf-8")
    assert executive(monkeypatch, "estimate", "run.mcap", *words) == 2
    assert capsys.readouterr().err.startswith(f"error: {told}")
    assert Path("run.mcap").read_text(encoding="utf-8").startswith("1 0 0")


def test_an_imported_tree_is_not_written_over(monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    Path("patrol.xml").write_text("<root/>", encoding="utf-8")
    assert executive(monkeypatch, "import", "patrol.xml", "--out", "patrol.xml") == 2
    assert "--out: patrol.xml is a file that is read" in capsys.readouterr().err
    assert Path("patrol.xml").read_text(encoding="utf-8") == "<root/>"
