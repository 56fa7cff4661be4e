"""The files of an estimate: their names, and the poses in the format of TUM."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.errors import ConfigError
from executive.estimate import files
from executive.estimate.files import write_files

TURN = Rotation.from_euler("zyx", [0.9, -0.2, 0.1])


def poses(*places: tuple[float, float, float]) -> np.ndarray:
    found = np.tile(np.eye(4), (len(places), 1, 1))
    found[:, :3, :3], found[:, :3, 3] = TURN.as_matrix(), places
    return found


MATERIAL = SimpleNamespace(
    log=SimpleNamespace(origin_ns=1_700_000_000_000_000_000),
    rig=SimpleNamespace(cabin_link="cabin"),
    drops=["a drop"],
)
TRACK = SimpleNamespace(
    stamps_s=np.array([0.25, 0.5]),
    T_map_base=poses((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)),
    T_odom_base=poses((7.0, 8.0, 9.0), (0.0, 0.0, 1.0)),
)
SMOOTHED = SimpleNamespace(stamps_s=np.array([0.75]), T_map_base=poses((1.5, 2.5, 3.5)))


def estimated(reference: object = None) -> SimpleNamespace:
    replay = SimpleNamespace(states=["a state"])
    return SimpleNamespace(track=TRACK, replay=replay, report={"log": "a"}, reference=reference)


@pytest.fixture
def other(monkeypatch: pytest.MonkeyPatch) -> list[tuple[object, ...]]:
    """What the plot and the exports are given."""
    given: list[tuple[object, ...]] = []
    monkeypatch.setattr(files, "plot", lambda *words: given.append(("plot", *words)))
    monkeypatch.setattr(files, "write_states", lambda *words: given.append(("states", *words)))
    return given


def test_poses_report_plot_and_exports_are_written_and_named(tmp_path: Path, other) -> None:
    found, out = estimated(), tmp_path / "run.tum"
    export = tmp_path / "states.csv"
    written = write_files(out, MATERIAL, found, [export])
    names = ["run.tum", "run_odom.tum", "run.json", "run.png", "states.csv"]
    assert written == tuple(tmp_path / name for name in names)
    assert json.loads((tmp_path / "run.json").read_text()) == {"log": "a"}
    assert (tmp_path / "run.json").read_text().endswith("}\n")
    assert other == [
        ("states", export, ["a state"], 1_700_000_000.0, "cabin"),
        ("plot", tmp_path / "run.png", found, ["a drop"]),
    ]


def test_a_line_is_stamp_place_and_quaternion(tmp_path: Path, other) -> None:
    write_files(tmp_path / "run.tum", MATERIAL, estimated())
    lines = (tmp_path / "run.tum").read_text().splitlines()
    turn = " ".join(f"{q:.7f}" for q in TURN.as_quat())
    assert lines == [
        f"1700000000.250000 1.00000 2.00000 3.00000 {turn}",
        f"1700000000.500000 4.00000 5.00000 6.00000 {turn}",
    ]
    lines = (tmp_path / "run_odom.tum").read_text().splitlines()
    assert [line.split()[:4] for line in lines] == [
        ["1700000000.250000", "7.00000", "8.00000", "9.00000"],
        ["1700000000.500000", "0.00000", "0.00000", "1.00000"],
    ]


def test_the_trajectory_of_a_smoother_lies_beside_it(tmp_path: Path, other) -> None:
    written = write_files(tmp_path / "run.tum", MATERIAL, estimated(SMOOTHED))
    assert written[-1] == tmp_path / "run_smoothed.tum"
    assert len(written) == 5
    (line,) = written[-1].read_text().splitlines()
    assert line.split()[:4] == ["1700000000.750000", "1.50000", "2.50000", "3.50000"]


@pytest.mark.parametrize("suffix", ["json", "png"])
def test_the_names_of_report_and_plot_are_taken(tmp_path: Path, suffix: str) -> None:
    with pytest.raises(ConfigError, match=r"\.json and \.png are the names of report and plot"):
        write_files(tmp_path / f"run.{suffix}", MATERIAL, estimated())
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_none_is_told(tmp_path: Path, other) -> None:
    with pytest.raises(ConfigError, match=r"none/run\.tum.* cannot be written|cannot be written"):
        write_files(tmp_path / "none" / "run.tum", MATERIAL, estimated())
