"""Estimators are compared on one recorded run of a mission, against what the simulator knows."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from executive.commands.logs.recorded_mission import RecordedMission, is_mission
from executive.errors import DataError

SHORT = """
api: 1
mission: short
plugins:
  robot: {plugin: mujoco, model: mini, site: {stones: {count: 0}}}
  estimation: gnss_imu_filter
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - wait: 6 s
"""


def executive(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    code = (
        f"import sys; sys.argv = ['executive', *{list(words)!r}]; from "
        "executive.commands.main import main; main()"
    )
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=240, cwd=cwd
    )


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> dict:
    folder = tmp_path_factory.mktemp("rehearsal")
    (folder / "short.yaml").write_text(SHORT)
    words = ("short.yaml", "--seed", "3", "--drop", "gnss:3:6", "--json")
    ended = executive("compare-estimators", *words, cwd=folder)
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


def test_every_estimator_stands_beside_the_truth(compared: dict) -> None:
    assert set(compared) == {"dual_graph", "error_state_ekf", "gnss_imu_filter"}
    for report in compared.values():
        assert report["truth"]["error_m"]["mean"] < 0.02
        assert report["truth"]["error_m"]["max"] < 0.1
        assert report["odometry_step_m"] < 0.01


def test_an_outage_is_told_with_its_truth_and_its_end(compared: dict) -> None:
    for report in compared.values():
        (outage,) = report["outages"]
        assert (outage["from_s"], outage["to_s"]) == (3.0, 6.0)
        assert outage["truth"]["max"] < 0.1
        assert 0.0 <= outage["recovered_after_s"] < 1.5


def test_an_unknown_mission_ends_with_status_2(tmp_path: Path) -> None:
    ended = executive("compare-estimators", "map_siet", cwd=tmp_path)
    assert ended.returncode == 2
    assert "map_site" in ended.stderr
    assert "Traceback" not in ended.stderr


@pytest.mark.parametrize(
    ("name", "is_one"),
    [("map_site", True), ("a/b.yaml", True), ("x.mcap", False), ("x.bag", False)],
)
def test_a_mission_is_told_from_a_log(name: str, is_one: bool) -> None:
    assert is_mission(Path(name)) == is_one


def test_a_bag_is_a_folder(tmp_path: Path) -> None:
    assert not is_mission(tmp_path)


def test_without_an_oracle_the_truth_is_not_known() -> None:
    with pytest.raises(DataError, match="no oracle"):
        RecordedMission(Path("run.mcap"), None, None).truth([])
