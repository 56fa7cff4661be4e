"""Missions of a robot without physics, whose sensors have noise, with faults on purpose."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from executive.journal import Entry, read_journal
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

MISSION = """
api: 1
mission: swing
plugins:
  robot: {plugin: kinematic, model: m545, noise: true}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
watch:
  encoders: stop
  imu: {do: hold, wait: 15 s}
  gnss: {do: hold, after: 1 s, wait: 15 s}
  estimate: {do: hold, wait: 15 s}
  tracking: {do: stop, after: 0 s}
  joint_limits: stop
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 60 deg, duration: 6 s}
"""


@dataclass(frozen=True)
class Finished:
    """What a run has left."""

    report: dict[str, Any]
    status: int
    entries: list[Entry]

    def first(self, kind: str, from_s: float = 0.0) -> float | None:
        """Return when an event was recorded first from a time on [s]."""
        times = [e.time_s for e in self.entries if e.kind == kind and e.time_s >= from_s]
        return times[0] if times else None

    def of(self, kind: str) -> list[Any]:
        return [entry.event for entry in self.entries if entry.kind == kind]


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Finished]:
    """Run the mission with faults, given as YAML of one line, and settings."""
    number = iter(range(1000))

    def run_one(faults: str = "", *overrides: str, text: str = MISSION, seed: int = 1) -> Finished:
        path = tmp_path / f"mission_{next(number)}.yaml"
        path.write_text(text + (f"faults: [{faults}]\n" if faults else ""), encoding="utf-8")
        folder = path.with_suffix("")
        description = load_mission(str(path), overrides)
        result = Run(description, Options(seed=seed, run_dir=folder)).execute(lambda _: None)
        events = list(read_journal(folder / "journal.jsonl"))
        return Finished(result.report.payload(), result.exit_status, events)

    return run_one
