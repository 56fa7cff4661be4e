"""Whole missions as bulk work."""

import json
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pydantic import BaseModel

from executive import registry
from executive.campaign.description.mission_arguments import MissionArguments
from executive.campaign.execution.disk_space import DiskFullError, is_space_left
from executive.campaign.figures.measurement import measure, record_of
from executive.config import Settings
from executive.interfaces.work import Piece, Work
from executive.mission.assembly import Selections, assemble_for, machine_of, needed_for
from executive.mission.options import Options
from executive.mission.preset_answers import preset_answers
from executive.mission.run import Run
from executive.mission.selections import model_of
from executive.tree.instances import capability_of
from executive.tree.language import MissionFile
from executive.tree.load import load_mission

_started: set[str] = set()  # what plugins, with their settings, have started in this process


class MissionWork(Work):
    """One mission in lock-step: what it reports, and its measurements.

    A mission that fails, is stopped or ends in a fault has an answer as well: its report says so.
    """

    Arguments = MissionArguments
    keeps = ("*.json", "journal.jsonl", "log.txt", "output.txt", "mission.yaml")

    def inputs(self, arguments: Settings) -> Mapping[str, Path]:
        """Return the files and folders that settings of plugins name, by the setting."""
        return dict(_paths_in(_description(_checked(arguments).mission, ())))

    def prepare(self, arguments: Settings, inputs: Mapping[str, Path]) -> None:
        """Read the mission, and let its stateless plugins start once: they import and compile."""
        description = _description(_checked(arguments).mission, _moved(inputs))
        chosen = _stateless(description)
        if repr(chosen) in _started:
            return
        _started.add(repr(chosen))
        machine = machine_of(description.plugins, model_of(description))
        assembly = assemble_for(machine, chosen, seed=0)
        try:
            assembly.start()
        finally:
            assembly.close()

    def run(self, piece: Piece) -> Mapping[str, Any]:
        arguments = _checked(piece.arguments)
        description = _description(arguments.mission, _moved(piece.inputs))
        preset = preset_answers(arguments.answers, description)
        options = Options(
            seed=piece.seed, run_dir=piece.folder, answer=preset.answer, choices=preset.choices
        )
        result = Run(description, options).execute(_nothing)
        if result.report.outcome == "fault" and not is_space_left(piece.folder):
            raise DiskFullError(f"no space is left for {piece.folder}")
        return {"report": result.report.payload(), "measurements": _measured(piece.folder)}


def _stateless(description: MissionFile) -> Selections:
    """Return the plugins that neither have a state nor need one that does, such as the robot."""
    chosen = description.plugins
    return {
        capability: several
        for capability, several in chosen.items()
        if all(
            registry.load(capability_of(name), one.name).is_stateless
            for name, needed in needed_for(chosen, capability).items()
            for one in needed
        )
    }


def _nothing(_: object) -> None:
    """Show no progress after a tick."""


def _checked(arguments: Settings) -> MissionArguments:
    if not isinstance(arguments, MissionArguments):
        raise TypeError(f"expected MissionArguments, got {type(arguments).__name__}")
    return arguments


@lru_cache(maxsize=64)
def _description(text: str, overrides: tuple[str, ...]) -> MissionFile:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "mission.yaml"
        path.write_text(text, encoding="utf-8")
        return load_mission(str(path), overrides)


def _paths_in(description: MissionFile) -> Iterator[tuple[str, Path]]:
    for capability, several in description.plugins.items():
        for one in several:
            name = f"{capability}.{one.name}" if len(several) > 1 else capability
            yield from _paths_of(one.settings, name)


def _paths_of(settings: BaseModel, name: str) -> Iterator[tuple[str, Path]]:
    """Yield the paths among settings, and texts that may be one, such as that of weights."""
    for field in type(settings).model_fields:
        value = getattr(settings, field)
        if isinstance(value, BaseModel):
            yield from _paths_of(value, f"{name}.{field}")
        elif isinstance(value, Path):
            yield f"{name}.{field}", value
        elif isinstance(value, str) and "/" in value and Path(value).is_absolute():
            yield f"{name}.{field}", Path(value)


def _moved(inputs: Mapping[str, Path]) -> tuple[str, ...]:
    """Return the settings with the paths of the inputs on this computer."""
    return tuple(f"{name}={json.dumps(str(path))}" for name, path in sorted(inputs.items()))


def _measured(folder: Path) -> dict[str, dict[str, Any]]:
    """Return every installed metric; one that is broken says so in its place."""
    record = record_of(folder)
    measured: dict[str, dict[str, Any]] = {}
    for one in registry.installed(registry.METRICS):
        try:
            measured |= measure(record, (one.name,))
        except registry.BrokenPluginError as error:
            measured[one.name] = {"problem": str(error)}
    return measured
