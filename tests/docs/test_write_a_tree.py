"""The page on writing a tree is true: its mission has no mistake, its commands work, its tables are
complete.
"""

import re
import shlex
import sys
from pathlib import Path
from typing import Any

import pytest

from executive.commands.main import main
from executive.tree.catalogue import InstalledCatalogue
from executive.tree.kind_keys import KINDS, MODIFIERS
from executive.tree.load import load_mission

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "write_a_tree.md").read_text(
    encoding="utf-8"
)
MISSION = re.search(r"```yaml\n(.*?)```", PAGE, re.S).group(1)
COMMANDS = [
    shlex.split(line, comments=True)
    for line in re.search(r"```sh\n(.*?)```", PAGE, re.S).group(1).splitlines()
]


@pytest.fixture
def executive(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Any:
    """Run the command line in this process, in the folder of the mission; return status, output and
    errors.
    """

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.chdir(folder)
        monkeypatch.setattr(sys, "argv", ["executive", *words])
        try:
            main()
        except SystemExit as end:
            return int(end.code or 0), *capsys.readouterr()
        return 0, *capsys.readouterr()

    return run


PATROL = """
<root BTCPP_format="4" main_tree_to_execute="Patrol">
  <BehaviorTree ID="Patrol">
    <Sequence>
      <Localise/>
      <SurveySite/>
    </Sequence>
  </BehaviorTree>
</root>
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "my_wall.yaml").write_text(MISSION, encoding="utf-8")
    (tmp_path / "patrol.xml").write_text(PATROL, encoding="utf-8")
    return tmp_path


def test_the_mission_has_no_mistake(folder: Path) -> None:
    mission = load_mission(str(folder / "my_wall.yaml"), catalogue=InstalledCatalogue())
    assert mission.plugins["placing"][0].settings.spacing_m == 1.6
    assert not mission.warnings


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_a_command_works(words: list[str], executive: Any) -> None:
    status, output, errors = executive(*words[1:])
    assert status == 0, errors
    assert output + errors


def test_the_mistakes_are_told_as_the_page_says(folder: Path, executive: Any) -> None:
    wrong = MISSION.replace("spacing_m", "spacing").replace("30 s", "30 kg")
    wrong = wrong.replace('places: "{course}"', 'places: "{cuorse}"')
    (folder / "my_wall.yaml").write_text(wrong, encoding="utf-8")
    shown = re.search(r"```text\n(.*?)```", PAGE, re.S).group(1).splitlines()
    status, _, errors = executive("check", "my_wall.yaml")
    assert status == 2
    assert errors.splitlines() == shown


def test_the_tables_name_every_kind_and_every_modifier_in_order() -> None:
    rows = re.findall(r"^\| `(\w+)[:`]", PAGE, re.M)
    kinds, modifiers = rows[: len(KINDS)], rows[len(KINDS) :]
    assert set(kinds) == set(KINDS)
    assert modifiers == list(MODIFIERS)


def test_the_page_is_one_page() -> None:
    assert len(PAGE.splitlines()) <= 175  # the tables alone have a line for each of thirty words
