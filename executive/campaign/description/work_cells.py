"""Cells of another installed work: settings laid over its arguments, checked by its class."""

from collections.abc import Mapping
from typing import Any

from executive import registry
from executive.campaign.description.cells import Cell
from executive.campaign.description.paths import Paths, relative_paths
from executive.errors import ConfigError
from executive.interfaces.work import Work
from executive.tree.override import PlacedSetting
from executive.tree.reading import Reading
from executive.tree.settings import check_settings, settings_dump
from executive.tree.value import Table, TableEntry, Value, merged


class WorkCells:
    """Checks the cells of a work; the keys of settings are paths such as `planner.samples`."""

    def __init__(
        self, work: tuple[str, type[Work]], common: Table, paths: Paths, reading: Reading
    ) -> None:
        """Take name and class of the work, and the arguments that all its runs share."""
        self._name, self._work = work
        self._common = common
        self._paths = paths
        self._reading = reading

    def arguments(self, cell: Cell) -> Mapping[str, Any] | None:
        """Return the arguments of the runs of a cell, or None after every mistake was noted."""
        given: Value = self._common
        for setting in cell.settings:
            given = merged(given, _nested(setting))
        if not isinstance(given, Table):
            return None
        owner, problems = f"work '{self._name}'", self._reading.problems
        arguments = Table(given.entries, self._common.mark)
        checked = check_settings(self._work.Arguments, arguments, owner, problems)
        if checked is None:
            return None
        self._paths.add(relative_paths(arguments, checked))
        absolute = self._paths.made_absolute(arguments)
        if isinstance(absolute, Table):
            checked = check_settings(self._work.Arguments, absolute, owner, problems) or checked
        return settings_dump(checked)

    def finish(self) -> None:
        """Do nothing: all that a work is given belongs to its arguments."""


def find_work(value: Value, reading: Reading) -> tuple[str, type[Work]] | None:
    """Return name and class of a work, or None after a mistake was noted."""
    name = reading.text(value, "'work'")
    if name is None:
        return None
    try:
        work = registry.load(registry.WORKS, name)
    except ConfigError as error:
        reading.fail(value, str(error))
        return None
    if issubclass(work, Work):
        return name, work
    reading.fail(value, f"work '{name}' ({work.__qualname__}) is no Work")
    return None


def _nested(setting: PlacedSetting) -> Value:
    value = setting.value
    for step in reversed(setting.key.split(".")):
        value = Table({step: TableEntry(setting.mark, value)}, setting.mark)
    return value
