"""A mission as bulk work is the same mission, with its inputs by name."""

import errno
import shutil
import sys
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

import pytest

from executive.campaign.description.mission_arguments import MissionArguments
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.isolation import Isolation
from executive.campaign.mission_work import MissionWork
from executive.campaign.trial import Limits, Outcome, Status, Trial
from executive.commands.main import main
from executive.interfaces.work import Piece
from executive.tree.load import load_mission
from executive.tree.resolved import resolved_yaml

MISSION = """
api: 1
mission: dry
loop: {time_limit: 3 s}
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  segmentation: ground_and_clusters
  motion: hermite
  objects: sqlite
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 30 deg, duration: 2 s}
"""


@pytest.fixture
def mission(tmp_path: Path) -> Path:
    path = tmp_path / "dry.yaml"
    path.write_text(MISSION)
    return path


def arguments_of(path: Path, *settings: str) -> MissionArguments:
    return MissionArguments(mission=resolved_yaml(load_mission(str(path), settings)))


def test_inputs_are_absolute_paths_among_settings(mission: Path, tmp_path: Path) -> None:
    weights = tmp_path / "weights.safetensors"
    text = MISSION.replace(
        "  motion: hermite\n",
        f"""  motion: hermite
  grasping: {{plugin: sampled_cnn, weights: {weights}}}
""",
    )
    mission.write_text(text)
    found = MissionWork().inputs(arguments_of(mission))
    assert dict(found) == {"grasping.weights": weights}
    mission.write_text(text.replace(str(weights), "shipped/one"))
    assert not MissionWork().inputs(arguments_of(mission))


def journal_of_command(mission: Path, folder: Path, seed: int, monkeypatch) -> bytes:
    monkeypatch.setattr(
        sys,
        "argv",
        ["executive", "run", str(mission), "--seed", str(seed), "--run-dir", str(folder)],
    )
    with pytest.raises(SystemExit):
        main()
    return (folder / "journal.jsonl").read_bytes()


def isolated(trial: Trial, folder: Path, inputs: Mapping[str, Path]) -> Outcome:
    folder.mkdir()
    isolation = Isolation()
    try:
        running = isolation.begin(trial, folder, inputs)
        while (result := running.poll()) is None:
            isolation.wait(0.1)
    finally:
        isolation.close()
    assert isinstance(result, Outcome)
    return result


def test_a_seed_gives_the_journal_that_the_command_gives(mission, tmp_path, monkeypatch) -> None:
    arguments = arguments_of(mission)
    trial = Trial(0, "mission", arguments.model_dump(), 3, {}, Limits(120.0, 4 << 30))
    outcome = isolated(trial, tmp_path / "campaign", {})
    assert outcome.status is Status.DONE, outcome.reason
    assert outcome.answer["report"]["seed"] == 3
    assert "measurements" in outcome.answer
    journal = (tmp_path / "campaign" / "journal.jsonl").read_bytes()
    assert len(journal.splitlines()) > 10
    assert journal == journal_of_command(mission, tmp_path / "command", 3, monkeypatch)


def test_a_mission_that_fails_has_an_answer(mission, tmp_path) -> None:
    mission.write_text(MISSION.replace("time_limit: 3 s", "time_limit: 0.5 s"))
    piece = Piece(arguments_of(mission), 1, tmp_path, {})
    answer = MissionWork().run(piece)
    assert answer["report"]["outcome"] == "failure"


@pytest.mark.parametrize(("answer", "outcome"), [("slowly", "success"), ("not", "failure")])
def test_the_answers_of_a_campaign_reach_the_missions_questions(
    mission: Path, tmp_path: Path, answer: str, outcome: str
) -> None:
    ask = "{ask: How?, choices: [slowly, not]}"
    trees = f"trees:\n  main: {{sequence: [{ask}, {{check: \"{{answer}} == 'slowly'\"}}]}}\n"
    mission.write_text(MISSION.partition("trees:")[0] + trees)
    arguments = arguments_of(mission).model_copy(update={"answers": (answer,)})
    report = MissionWork().run(Piece(arguments, 1, tmp_path / "run", {}))["report"]
    assert report["outcome"] == outcome


def test_a_fault_of_a_full_disk_is_none_of_the_mission(mission, tmp_path, monkeypatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("executive_plugins.mapping.voxel_map.VoxelMap.start", full)
    answer = MissionWork().run(Piece(arguments_of(mission), 1, tmp_path / "roomy", {}))
    assert answer["report"]["outcome"] == "fault"
    monkeypatch.setattr("executive.campaign.mission_work.is_space_left", lambda _: False)
    with pytest.raises(DiskFullError):
        MissionWork().run(Piece(arguments_of(mission), 1, tmp_path / "full", {}))


def test_paths_among_settings_are_inputs_by_the_settings_name(tmp_path: Path) -> None:
    stones = tmp_path / "stones"
    stones.mkdir()
    (stones / "a.obj").write_text("v 0 0 0\n")
    survey = tmp_path / "drone.ply"
    survey.write_text("ply\n")
    arguments = arguments_of(
        Path("map_site"),
        f'robot.site.stones.folder="{stones}"',
        "surveying.plugin=point_cloud_file",
        f'surveying.path="{survey}"',
    )
    inputs = MissionWork().inputs(arguments)
    assert inputs == {"robot.site.stones.folder": stones, "surveying.path": survey}


def test_a_run_reads_its_inputs_where_they_have_been_brought(mission, tmp_path: Path) -> None:
    here, brought = tmp_path / "here", tmp_path / "brought"
    shutil.copytree(str(files("executive_robot_models") / "m545"), here)
    arguments = arguments_of(mission, f'robot.model="{here}"')
    assert MissionWork().inputs(arguments) == {"robot.model": here}
    here.rename(brought)
    folder = tmp_path / "run"
    MissionWork().run(Piece(arguments, 1, folder, {"robot.model": brought}))
    assert str(brought) in (folder / "mission.yaml").read_text()


def test_preparing_leaves_no_file(mission, tmp_path: Path) -> None:
    before = set(tmp_path.rglob("*"))
    MissionWork().prepare(arguments_of(mission), {})
    assert set(tmp_path.rglob("*")) == before
