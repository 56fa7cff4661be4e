"""The page on objects is true: its commands and its program run,
and its tables name what there is.
"""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.commands.main import main
from executive.commands.stones.answer import object_answer
from executive.messages.segment import Segment
from executive.messages.stone import StoneState

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "objects.md").read_text(encoding="utf-8")
COMMANDS = re.findall(
    r"^(executive .*?)(?:\s+#.*)?$", re.search(r"```sh\n(.*?)```", PAGE, re.S).group(1), re.M
)
PROGRAM = re.search(r"```python\n(.*?)```", PAGE, re.S).group(1)


@pytest.fixture
def objects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[SqliteObjects]:
    """The run that the page speaks of, with one stone."""
    folder = tmp_path / "runs" / "relocate"
    folder.mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    database = SqliteObjects(SqliteObjectsSettings())
    database.open(str(folder / "objects.sqlite"))
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (500, 3))
    database.observe([Segment(0, points, np.zeros(3), np.ones(3))], 1.0, True)
    yield database
    database.close()


def test_the_commands_run(
    objects: SqliteObjects, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert len(COMMANDS) == 3
    for command in COMMANDS:
        monkeypatch.setattr("sys.argv", shlex.split(command))
        with pytest.raises(SystemExit) as ended:
            main()
        assert not ended.value.code
    assert {path.name for path in (tmp_path / "stones").iterdir()} == {"stone_001.ply", "poses.csv"}


def test_the_program_runs(objects: SqliteObjects, capsys: pytest.CaptureFixture) -> None:
    exec(compile(PROGRAM, "objects.md", "exec"), {})
    assert capsys.readouterr().out.startswith("1 on_ground [")


def test_the_tables_name_every_key_state_and_kind(objects: SqliteObjects) -> None:
    words = set(re.findall(r"`(\w+)`", PAGE))
    stone = objects.stone(1)
    assert set(object_answer(stone, objects.history(1))) - {"points"} <= words
    assert {state.value for state in StoneState} <= words
    assert {"found", "seen", "moved", "replaced", "grasp", "release", "realign", "state"} <= words
    assert set(object_answer(stone, objects.history(1))["history"][0]) <= words


def test_the_limits_are_the_settings() -> None:
    settings = SqliteObjectsSettings()
    for words in (
        f"above {settings.min_agreement} within {100 * settings.agreement_m:.0f} cm",
        f"RMSE below {100 * settings.max_rmse_m:.0f} cm",
        f"at most {100 * (settings.max_growth - 1):.0f} %, or "
        f"{100 * (settings.max_growth_whole - 1):.0f} %",
        f"a cell ({100 * settings.voxel_m:.0f} cm)",
        f"{settings.max_points:,} points",
    ):
        assert words in " ".join(PAGE.split()), words
