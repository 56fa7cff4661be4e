"""The page on expressions is true: its mission has no mistake, its mistakes are as it says, and
it names every function.
"""

import re
from pathlib import Path

import pytest

from executive.tree.catalogue import InstalledCatalogue
from executive.tree.expressions.parser import FUNCTIONS, OVERS
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.resolved import resolved_yaml

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "expressions.md").read_text(
    encoding="utf-8"
)
MISSION = re.search(r"```yaml\n(.*?)```", PAGE, re.S).group(1)


def test_the_mission_has_no_mistake_and_loads_again(tmp_path: Path) -> None:
    path = tmp_path / "look_around.yaml"
    path.write_text(MISSION, encoding="utf-8")
    mission = load_mission(str(path), catalogue=InstalledCatalogue())
    assert not mission.warnings
    again = tmp_path / "again.yaml"
    again.write_text(resolved_yaml(mission), encoding="utf-8")
    assert resolved_yaml(load_mission(str(again))) == resolved_yaml(mission)


def test_the_mistakes_are_told_as_the_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = MISSION.replace("len({stones}) >=", "len({stone}) >=")
    wrong = wrong.replace("{s.extents[0]})) < 50", "{s.extent[0]})) < 50")
    wrong = wrong.replace("> 0.9 m", "> 0.9 t").replace(
        '{angle: "{angle}", dur', '{angle: "{pace}", dur'
    )
    (tmp_path / "look_around.yaml").write_text(wrong, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(MissionFileError) as caught:
        load_mission("look_around.yaml", catalogue=InstalledCatalogue())
    shown = re.search(r"```text\n(.*?)```", PAGE, re.S).group(1).splitlines()
    assert [str(problem) for problem in caught.value.problems] == shown


def test_the_page_names_every_function() -> None:
    for name in (*FUNCTIONS, *OVERS):
        assert f"`{name}(" in PAGE, name
