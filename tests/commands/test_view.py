"""`--view`: a result is written for a viewer, and shown where there is a display."""

import socket
import sys
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from executive import extras
from executive.clouds.ply_writer import write_parts
from executive.commands.clouds.view import show
from executive.commands.main import main
from executive.messages.cloud import Cloud

PLACE = np.array([2_600_000.0, 1_200_000.0, 440.0])
HEADLESS = {"DISPLAY": "", "WAYLAND_DISPLAY": ""}


def site() -> np.ndarray:
    rng = np.random.default_rng(3)
    way = rng.normal(size=(9000, 3))
    lump = way / np.linalg.norm(way, axis=1)[:, None] * [0.5, 0.45, 0.4] + [1, -1, 0.2]
    ground = rng.uniform([-4, -4, 0], [4, 4, 0.02], (30_000, 3))
    return np.vstack([ground, lump[lump[:, 2] > 0]])


def executive(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["executive", *map(str, words)])
    for name, value in HEADLESS.items():
        monkeypatch.setenv(name, value)
    try:
        main()
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0


def drawn(path: Path) -> dict[str, np.ndarray]:
    """Return the points of a recording by the place at which they are drawn."""
    found: dict[str, np.ndarray] = {}
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        if "Points3D:positions" in batch.schema.names:
            rows = batch["Points3D:positions"].to_pylist()
            found[str(chunk.entity_path)] = np.array(rows[-1])
    return found


@pytest.fixture
def cloud(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_parts(Path("site.ply"), [site() + PLACE], "EPSG:2056")
    return Path("site.ply")


def test_segments_are_written_to_the_centimetre_where_national_coordinates_are_large(
    cloud: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    assert executive(monkeypatch, "segment", cloud, "--view") == 0
    told = capsys.readouterr().err
    assert "view: site.rrd; `rerun --bind 127.0.0.1 site.rrd` shows it" in told
    assert "there is no display" in told
    assert "shown about 2600000 1200000 440 m" in told
    found = drawn(Path("site.rrd"))
    assert {"/world/cloud", "/world/segments/0", "/world/segments/ground"} <= set(found)
    assert not [one for one in found if "machine" in one]
    assert len(found["/world/cloud"]) == len(site())
    assert np.allclose(found["/world/segments/0"].mean(axis=0)[:2], [1, -1], atol=0.05)
    assert np.ptp(found["/world/segments/0"], axis=0)[0] == pytest.approx(1.0, abs=0.02)


def test_an_alignment_is_written_beside_its_clouds_if_it_is_accepted(
    cloud: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(4)
    block = site() + PLACE + rng.normal(0, 0.002, site().shape)
    write_parts(Path("moved.ply"), [block + [0.05, 0.02, 0.0]])
    words = ("align", "moved.ply", cloud, "--view", "--out", "both.ply")
    assert executive(monkeypatch, *words) == 0
    found = drawn(Path("both.rrd"))
    lowest = {name: points.min(axis=0) for name, points in found.items()}
    assert set(found) == {"/world/target", "/world/drone"}
    assert np.allclose(lowest["/world/target"], lowest["/world/drone"], atol=0.02)
    write_parts(Path("bare.ply"), [block[:30_000]])
    assert executive(monkeypatch, "align", "bare.ply", cloud, "--view", "--guess", "9,9,9") == 1
    assert set(drawn(Path("bare.rrd"))) == {"/world/target"}


def test_a_viewer_that_listens_is_used_where_there_is_a_display(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    shown = {"cloud": Cloud("map", site())}
    with socket.socket() as taken:  # what listens there never answers: the file has the result
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        show(tmp_path / "a.rrd", shown, {"DISPLAY": ":0"}, port)
    assert f"view: the viewer that listens at 127.0.0.1:{port}" in capsys.readouterr().err
    assert len(drawn(tmp_path / "a.rrd")["/world/cloud"]) == len(site())


def test_a_viewer_that_does_not_start_is_told_and_the_file_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    from executive_plugins.viewing import live_viewer

    monkeypatch.setattr(live_viewer.sys, "executable", "/bin/false")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    show(tmp_path / "a.rrd", {"cloud": Cloud("map", site())}, {"DISPLAY": ":0"}, port)
    assert "view: no viewer: " in capsys.readouterr().err
    assert len(drawn(tmp_path / "a.rrd")["/world/cloud"]) == len(site())


def test_a_folder_and_a_missing_package_are_refused_before_anything_is_computed(
    cloud: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    assert executive(monkeypatch, "segment", ".", "--view", "--out", "answers") == 2
    assert "--view: shows one cloud" in capsys.readouterr().err
    is_there = extras._is_installed
    monkeypatch.setattr(extras, "_is_installed", lambda one: one != "rerun-sdk" and is_there(one))
    for words in (("segment", cloud), ("align", cloud, cloud), ("register", cloud, cloud)):
        assert executive(monkeypatch, *words, "--view") == 2
        assert 'pip install "executive[viewing]"' in capsys.readouterr().err
    assert not list(Path().glob("*.rrd"))
