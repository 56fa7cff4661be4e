"""A mission run once and recorded, and the truth about it where a simulator knows it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from executive import registry
from executive.errors import DataError
from executive.estimate.compare import compare
from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions
from executive.events.event import plain
from executive.interfaces.oracle import MissionView, Oracle
from executive.messages.base_state import BaseState
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.language import MissionFile
from executive.tree.load import load_mission

_LOGS = (".mcap", ".bag")


@dataclass(frozen=True, slots=True, eq=False)
class RecordedMission:
    """A run that was recorded.

    Attributes:
        log: What the robot measured.
        oracle: Gives the truth; none on a robot that has no oracle.
        datum: Origin of the map: latitude [deg], longitude [deg], altitude [m]; none for the log's
            first fix.
    """

    log: Path
    oracle: Oracle | None
    datum: tuple[float, float, float] | None

    def truth(self, states: Sequence[BaseState]) -> Mapping[str, Mapping[str, float]]:
        """Return how far states were from the truth; only reports may ask."""
        if self.oracle is None:
            raise DataError(
                f"{self.log}: this robot has no oracle, so the truth about the run is not known"
            )
        view = MissionView(states=states, stones=(), slots={}, attempts=())
        found = plain(self.oracle.truth(view).estimate)
        return cast(Mapping[str, Mapping[str, float]], found)


def is_mission(name: Path) -> bool:
    """Tell the name of a mission from a log: a log is a folder, or a file that is named as one."""
    return not name.is_dir() and name.suffix not in _LOGS


def record_mission(
    mission: str, overrides: Sequence[str], seed: int, folder: Path
) -> RecordedMission:
    """Run a mission to its end, whatever that is, and record what the robot measured.

    Raises:
        ConfigError: As `executive run`.
    """
    description = load_mission(mission, list(overrides))
    log = folder / "recorded.mcap"
    oracles: list[Oracle] = []

    def watch(running: Mission) -> None:
        if not oracles:
            oracles.extend(_oracles(description, running))

    Run(description, Options(seed=seed, run_dir=folder / "run", record_log=log)).execute(watch)
    settings = description.plugins["estimation"][0].settings
    return RecordedMission(log, oracles[0] if oracles else None, getattr(settings, "datum", None))


def compare_on(
    recorded: RecordedMission, names: Sequence[str], options: EstimateOptions
) -> dict[str, dict[str, Any]]:
    """Return the report of each estimator on the run, against the truth where it is known."""
    material = Material.read(recorded.log, options)
    if recorded.datum is not None:
        material = replace(material, datum=np.array(recorded.datum))
    return compare(
        material, names, options, recorded.truth if recorded.oracle is not None else None
    )


def _oracles(description: MissionFile, running: Mission) -> list[Oracle]:
    name = description.plugins["robot"][0].name
    if name not in registry.names(registry.ORACLES):
        return []
    oracle: Oracle = registry.load(registry.ORACLES, name)(running.services.plugins["robot"])
    return [oracle]
