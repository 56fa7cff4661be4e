"""A package brings a capability: its interface, a plugin, a message and a leaf, in a mission."""

from collections.abc import Callable
from pathlib import Path

import pytest

from executive import registry
from executive.commands.plugins.doctor import diagnose
from executive.mission.options import Options
from executive.mission.run import Run
from executive.testing.run import Trial, hold_to_contract
from executive.tree.load import load_mission
from executive.tree.schema import mission_schema

SOURCE = '''
"""A drill: it turns, and its depth comes with observations of its own."""
from abc import ABC, abstractmethod
from dataclasses import dataclass

from pydantic import Field

from executive.config import Settings
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded


class Drill(Plugin, ABC):
    """Make holes."""
    capability = "drill"

    @abstractmethod
    def depth(self) -> float:
        """Return the depth of the hole [m]."""


class AugerSettings(Settings):
    """How fast it sinks."""
    step_m: float = Field(0.1, gt=0, le=1, description="Depth of one turn [m].")


class Auger(Drill):
    """Sink by one step each time that it is asked."""
    Settings = AugerSettings

    def __init__(self, settings: AugerSettings) -> None:
        self._settings = settings
        self._turns = 0

    def depth(self) -> float:
        self._turns += 1
        return self._turns * self._settings.step_m


@dataclass(frozen=True, slots=True)
class Drilled:
    """A hole.

    Attributes:
        depth_m: Its depth [m].
    """
    depth_m: float


class DrillHole(Action):
    """Turn three times."""
    needs = (Drill,)

    def run(self) -> Steps[Drilled]:
        """Drill."""
        drill = self.context.use(Drill)
        drill.depth()
        yield None
        drill.depth()
        depth_m = drill.depth()
        return succeeded(Drilled(depth_m)) if depth_m > 0.5 else failed(f"only {depth_m:g} m")
'''
MISSION = """\
api: 1
mission: drill_once
plugins:
  robot: kinematic
  estimation: gnss_imu_filter
  drill: {plugin: auger, step_m: %s}
trees:
  main:
    sequence:
      - run: DrillHole
"""

Install = Callable[..., Path]


@pytest.fixture
def drill(install: Install) -> None:
    install(
        "my_drill",
        {"my_drill.py": SOURCE},
        {
            "capability": {"drill": "my_drill:Drill"},
            "drill": {"auger": "my_drill:Auger"},
            "behaviour": {"DrillHole": "my_drill:DrillHole"},
        },
    )


@pytest.mark.usefixtures("drill")
def test_the_capability_stands_behind_the_shipped_ones() -> None:
    assert registry.capabilities() == (*registry.CAPABILITIES, "drill")
    assert registry.interface("drill").__name__ == "Drill"
    assert "drill" in mission_schema()["properties"]["plugins"]["properties"]
    assert not [one for one in diagnose() if one["name"] in ("auger", "drill") and one["problem"]]


@pytest.mark.usefixtures("drill")
@pytest.mark.parametrize(("step_m", "outcome"), [("0.2", "success"), ("0.1", "failure")])
def test_a_mission_drills(tmp_path: Path, step_m: str, outcome: str) -> None:
    (tmp_path / "drill_once.yaml").write_text(MISSION % step_m)
    mission = load_mission(str(tmp_path / "drill_once.yaml"), [])
    result = Run(mission, Options(run_dir=tmp_path / "run")).execute(lambda mission: None)
    assert result.report.outcome == outcome


@pytest.mark.usefixtures("drill")
def test_the_kit_holds_its_plugin_and_its_leaf() -> None:
    for capability, name in (("drill", "auger"), ("leaf", "DrillHole")):
        findings = hold_to_contract(Trial(capability, name))
        assert [one.line() for one in findings if one.outcome == "fail"] == []
        assert sum(one.outcome == "pass" for one in findings) >= 7
