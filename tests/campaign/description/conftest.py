"""Campaign files as text, and a mission that loads in a moment."""

from collections.abc import Callable
from pathlib import Path

import pytest

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.load import load_campaign
from executive.campaign.description.options import CampaignOptions
from executive.tree.problem import MissionFileError

MISSION = """
api: 1
mission: waits
plugins:
  robot: {plugin: kinematic}
  estimation: gnss_imu_filter
trees:
  main: {wait: 1 s}
"""
HEAD = "api: 1\ncampaign: one\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the missions `waits.yaml` and `other.yaml`."""
    (tmp_path / "waits.yaml").write_text(MISSION)
    (tmp_path / "other.yaml").write_text(MISSION.replace("1 s", "2 s"))
    return tmp_path


@pytest.fixture
def asking(folder: Path) -> Path:
    """Return a mission with a question of yes or no, one with choices, and one with a default."""
    asks = """
    sequence:
      - ask: Go?
      - ask: How?
        choices: [slowly, quickly]
      - ask: Again?
        default: false"""
    path = folder / "asks.yaml"
    text = MISSION.replace("mission: waits", "mission: asks").replace("{wait: 1 s}", asks)
    path.write_text(text)
    return path


@pytest.fixture
def read(folder: Path) -> Callable[..., Campaign]:
    """Return what reads the text of a campaign; `api`, name, missions and seeds are added."""

    def load(text: str, head: str = f"{HEAD}missions: waits.yaml\nseeds: 7\n", **options):
        path = folder / "campaign.yaml"
        path.write_text(head + text)
        return load_campaign(str(path), CampaignOptions(**options))

    return load


@pytest.fixture
def mistakes(read: Callable[..., Campaign]) -> Callable[..., list[str]]:
    """Return what reads the text of a campaign that is refused: the messages without the file."""

    def refused(text: str, *head: str, **options) -> list[str]:
        with pytest.raises(MissionFileError) as caught:
            read(text, *head, **options)
        problems = caught.value.problems
        return [
            f"{one.mark.line}:{one.mark.column} {one.message}"
            if one.mark.line
            else f"{one.mark} {one.message}"
            for one in problems
        ]

    return refused
