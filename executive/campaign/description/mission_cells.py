"""Cells whose runs are missions: each mission is loaded with its settings, and resolved."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from executive.campaign.description.answers import AnswerReader
from executive.campaign.description.cells import Cell
from executive.campaign.description.mission_arguments import MissionArguments
from executive.campaign.description.paths import Paths, Place, part_at, relative_paths
from executive.errors import did_you_mean
from executive.tree.language import MissionFile
from executive.tree.load import load_mission
from executive.tree.override import LOOP, PlacedSetting
from executive.tree.problem import Mark, MissionFileError
from executive.tree.reading import Reading
from executive.tree.resolved import resolved_yaml
from executive.tree.selection import Selection
from executive.tree.sources import shipped_names
from executive.tree.value import Scalar, Table, Value

WORK = "mission"  # the installed name of the work that runs missions


class MissionCells:
    """Checks the cells of missions."""

    def __init__(self, table: Table, paths: Paths, reading: Reading) -> None:
        """Take the campaign's table, to which a missing mission is reported."""
        self._table = table
        self._paths = paths
        self._reading = reading
        self._found: dict[Mark, str | None] = {}
        self._answers = AnswerReader(table, reading)

    def arguments(self, cell: Cell) -> Mapping[str, Any] | None:
        """Return the arguments of the runs of a cell, or None after every mistake was noted."""
        name = self._name_of(cell)
        mission = self._loaded(name, cell) if name else None
        if name is None or mission is None:
            return None
        self._paths.add(_paths_in(mission, cell))
        absolute = cell.with_absolute(self._paths)
        own = tuple(_own_paths(mission, absolute))
        if own or absolute != cell:
            absolute = replace(absolute, settings=(*absolute.settings, *own))
            mission = self._loaded(name, absolute)
        if mission is None or cell.mission is None:
            return None
        answers = self._answers.of(mission, cell.mission.mark)
        arguments = MissionArguments(mission=resolved_yaml(mission), answers=answers)
        return arguments.model_dump(mode="json", exclude_defaults=True)

    def finish(self) -> None:
        """Note what no cell has used."""
        self._answers.refuse_unused()

    def _name_of(self, cell: Cell) -> str | None:
        value = cell.mission
        if value is None:
            told = "'missions' is missing: files, or names of shipped missions"
            self._reading.fail(self._table, told)
            return None
        if value.mark not in self._found:
            self._found[value.mark] = self._find(value)
        return self._found[value.mark]

    def _find(self, value: Value) -> str | None:
        """Return the absolute path of a mission, or the name of a shipped one."""
        text = self._reading.text(value, "a mission")
        if text is None or text in shipped_names():
            return text
        try:
            path = self._paths.absolute(value.mark, text)
            if path.is_file():
                self._paths.add([(value.mark, text)])
                return str(path)
            beside = [one.name for one in path.parent.glob("*.yaml")]
        except OSError:  # a name that is too long
            beside = []
        near = did_you_mean(text, [*shipped_names(), *beside])
        self._reading.fail(value, f"no file and no shipped mission '{text}'{near}")
        return None

    def _loaded(self, name: str, cell: Cell) -> MissionFile | None:
        try:
            mission = load_mission(name, cell.settings, self._reading.catalogue)
        except MissionFileError as error:
            for problem in error.problems:
                self._reading.problems.error(problem.mark, problem.message)
            return None
        for problem in mission.warnings:
            self._reading.problems.warning(problem.mark, problem.message)
        return mission


def _paths_in(mission: MissionFile, cell: Cell) -> Iterator[Place]:
    """Yield the places of relative paths among the settings of a cell."""
    for setting in cell.settings:
        owner, path = _owner_of(setting.key, mission)
        if owner != LOOP:
            for checked in _checked(mission.plugins.get(owner, ()), path):
                yield from relative_paths(setting.value, checked)


def _owner_of(key: str, mission: MissionFile) -> tuple[str, str]:
    """Return the plugin that a setting is of, by capability or `capability.name`, and its path."""
    named = [one for one in mission.plugins if "." in one and key.startswith(f"{one}.")]
    owner = named[0] if named else key.partition(".")[0]
    return owner, key[len(owner) + 1 :]


def _own_paths(mission: MissionFile, cell: Cell) -> Iterator[PlacedSetting]:
    """Yield settings that make the mission's own relative paths absolute.

    As with `executive run`, they are relative to the current folder.
    """
    given = tuple(f"{one.key}." for one in cell.settings)
    mark = Mark("a path in the mission")
    for capability, several in mission.plugins.items():
        for one in several:
            owner = f"{capability}.{one.name}" if len(several) > 1 else capability
            for key, path in _relative(one.settings, owner):
                if not f"{key}.".startswith(given):
                    yield PlacedSetting(key, Scalar(str(path.resolve()), mark), mark)


def _relative(settings: BaseModel, owner: str) -> Iterator[tuple[str, Path]]:
    for field in type(settings).model_fields:
        value = getattr(settings, field)
        if isinstance(value, BaseModel):
            yield from _relative(value, f"{owner}.{field}")
        elif isinstance(value, Path) and not value.is_absolute():
            yield f"{owner}.{field}", value


def _checked(selections: tuple[Selection, ...], path: str) -> Iterator[Any]:
    """Yield what was checked at a path: of the plugin, or of the one that the path names first."""
    for one in selections:
        if len(selections) == 1:
            yield part_at(one.settings, path)
        elif path.partition(".")[0] == one.name:
            yield part_at(one.settings, path.partition(".")[2])
