"""The page on stones and places is true: its mission has no mistake, and it names every setting."""

import re
from pathlib import Path

from executive.leaf.stone_filter import OrderedStones
from executive.tree.load import load_mission

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "stones_and_places.md").read_text("utf-8")


def test_the_mission_has_no_mistake(tmp_path):
    path = tmp_path / "tidy_yard.yaml"
    path.write_text(re.search(r"```yaml\n(.*?)```", PAGE, re.S).group(1), encoding="utf-8")
    mission = load_mission(str(path))
    assert not mission.warnings
    assert sorted(mission.regions) == ["bank", "track", "yard"]


def test_every_criterion_is_on_the_page():
    assert [name for name in OrderedStones.model_fields if f"`{name}`" not in PAGE] == []
