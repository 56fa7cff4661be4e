"""What a command cannot write or show is refused before it reads or computes anything."""

import pytest

from executive import extras
from executive.extras import MissingExtraError
from tests.commands.in_process import executive

CLOUDS = {"register": ("a.ply", "b.ply"), "align": ("a.ply", "b.ply"), "segment": ("a.ply",)}


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
def test_a_setting_that_does_not_exist_is_refused(monkeypatch, capsys, tmp_path, verb):
    monkeypatch.chdir(tmp_path)
    capability = {"register": "registration", "align": "alignment", "segment": "segmentation"}[verb]
    words = (verb, *CLOUDS[verb], "--set", f"{capability}.plugin=nobody")
    assert executive(monkeypatch, *words) == 2
    assert f"no {capability} plugin 'nobody'" in capsys.readouterr().err
