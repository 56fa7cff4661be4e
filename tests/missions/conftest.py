"""Missions in the simulated world: thinned in what they cost, never in what is asserted of them."""

import json
import sys
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from math import inf
from pathlib import Path
from typing import Any

import pytest

from executive.commands.main import main
from executive.journal import read_journal
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

# Half of a run's time goes into lidar returns. With one firing in eight, a swing still gives a
# stone some thousand of them.
THIN = ("robot.sensors.azimuth_stride=8", "mapping.slice_s=0.05", "robot.scenario=kind")
TREE = """
api: 1
mission: short
extends: base
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 170 deg, duration: 15 s}
      - run: Segment
      - run: FindSlots
        with: {count: 3}
      - call: relocate_all
      - check: SomeStonePlaced
"""


@dataclass(frozen=True)
class Finished:
    """What a run has left in its folder, read back from there.

    Attributes:
        folder: The run's folder.
        exit_status: What the command line would have answered.
        report: `report.json`.
        journal: The lines of `journal.jsonl`, whose checksums have been verified.
    """

    folder: Path
    exit_status: int
    report: dict[str, Any]
    journal: list[dict[str, Any]]

    def events(self, *kinds: str) -> list[dict[str, Any]]:
        """Return the lines of some kinds in order of time."""
        return [line for line in self.journal if line["kind"] in kinds]

    def story(self, *kinds: str) -> list[tuple[int, str]]:
        """Return stone and kind of the lines of some kinds in order of time."""
        return [(line["payload"]["stone"], line["kind"]) for line in self.events(*kinds)]

    def endings(self, leaf: str, from_s: float = 0.0, to_s: float = inf) -> list[str]:
        """Return with what status a leaf ended each time in a span."""
        return [
            line["payload"]["status"]
            for line in self.events("node_ended")
            if line["node"].endswith(f":{leaf}") and from_s <= line["time_s"] < to_s
        ]


def _read(folder: Path, exit_status: int) -> Finished:
    journal = folder / "journal.jsonl"
    lines = [json.loads(line) for line in journal.read_text().splitlines()]
    assert len(list(read_journal(journal))) == len(lines)
    return Finished(folder, exit_status, json.loads((folder / "report.json").read_text()), lines)


@dataclass(frozen=True)
class Answer:
    """What a command has answered: exit status, standard output and standard error."""

    status: int
    out: str
    err: str


@pytest.fixture(scope="session")
def thin() -> tuple[str, ...]:
    """Return the settings that thin a mission."""
    return THIN


@pytest.fixture(scope="session")
def command_line() -> Callable[..., Answer]:
    """Call the command line as a shell does, in this process; a mission is thinned."""

    def call(*arguments: str) -> Answer:
        thin = [word for setting in THIN for word in ("--set", setting)]
        line = ["executive", *arguments, *(thin if arguments[0] == "run" else ())]
        out, err = StringIO(), StringIO()
        with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
            patch.setattr(sys, "argv", line)
            try:
                main()
                status = 0
            except SystemExit as ended:
                status = int(ended.code or 0)
        return Answer(status, out.getvalue(), err.getvalue())

    return call


@pytest.fixture(scope="session")
def read_run() -> Callable[[Path, int], Finished]:
    """Read a run's folder."""
    return _read


@pytest.fixture(scope="session")
def run_mission(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Finished]:
    """Run a mission to its end: a file's path, the name of a shipped one, or a file's text."""

    def run(
        *overrides: str,
        mission: str = TREE,
        after_tick: Callable[[Mission], None] = lambda mission: None,
        **options: Any,
    ) -> Finished:
        folder = tmp_path_factory.mktemp("mission")
        if "\n" in mission:
            (folder / "mission.yaml").write_text(mission)
            mission = str(folder / "mission.yaml")
        description = load_mission(mission, [*THIN, *overrides])
        result = Run(description, Options(run_dir=folder / "run", **options)).execute(after_tick)
        return _read(folder / "run", result.exit_status)

    return run


@pytest.fixture(scope="session")
def check_truth() -> Callable[[Finished, int], None]:
    """Assert what the simulator knows of a run that placed so many stones and hit nothing."""

    def check(finished: Finished, placed: int) -> None:
        truth = finished.report["truth"]
        assert truth["collisions"] == []
        on_slots = [stone for stone in truth["stones"] if stone["slot_error_m"] is not None]
        assert len(on_slots) == placed
        for stone in on_slots:
            assert stone["slot_error_m"] < 0.30  # what the report counts as on its slot
            assert stone["database_error_m"] < 0.05  # half of the jaws' room beside a stone
            assert stone["database_error_rad"] < 0.05  # 3°: turns the far end of a stone by 3 cm

    return check
