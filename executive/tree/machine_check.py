"""What only this machine and this computer can refuse: the machine's file, sensors, folders."""

from collections.abc import Iterable
from dataclasses import dataclass

from executive.errors import ConfigError
from executive.interfaces.declaration import MachineSettings
from executive.interfaces.robot import RobotSettings
from executive.machine.machine import (
    Machine,
    MachineFileError,
    load_machine,
    machine_file,
)
from executive.tree.document import read_file
from executive.tree.problem import Mark, Problems
from executive.tree.reading import Reading
from executive.tree.selection import Selection
from executive.tree.settings import placed
from executive.tree.sources import shown
from executive.tree.value import Table


@dataclass(frozen=True, slots=True)
class Written:
    """A selected plugin and the table of the file that selects it."""

    capability: str
    selection: Selection
    table: Table


def check_machine(plugins: Iterable[Written], reading: Reading) -> None:
    """Note what is wrong with the machine's file, and what plugins and leaves refuse of it."""
    plugins = tuple(plugins)
    robot = next((one for one in plugins if one.capability == "robot"), None)
    if robot is None or not isinstance(robot.selection.settings, RobotSettings):
        return
    machine = _machine(robot.selection.settings.model, robot.table, reading)
    if machine is None:
        return
    of_plugins = ((one.selection.settings, one.table) for one in plugins)
    of_leaves = ((one.settings, one.table) for one in reading.placed)
    for settings, table in (*of_plugins, *of_leaves):
        for refusal in settings.refusals(machine) if isinstance(settings, MachineSettings) else ():
            place = placed(table, refusal.setting, "")
            where = ".".join(map(str, refusal.setting))
            told = f"{where}: {refusal.message}" if where else refusal.message
            reading.problems.error(place.mark, told)


def _machine(model: str, robot: Table, reading: Reading) -> Machine | None:
    value = robot.get("model")
    mark = value.mark if value is not None else robot.mark
    try:
        return load_machine(model)
    except MachineFileError as error:
        _tell(model, error, mark, reading)
    except ConfigError as error:
        reading.problems.error(mark, str(error))
    return None


def _tell(model: str, error: MachineFileError, mark: Mark, reading: Reading) -> None:
    """Report each finding at its place in robot.yaml."""
    path = machine_file(model)
    found = Problems()
    table = read_file(path, shown(path), found, "machine")
    if not isinstance(table, Table) or not error.findings:
        for problem in found.all():
            reading.problems.error(problem.mark, problem.message)
        if not found.all():
            reading.problems.error(Mark(shown(path)), str(error))
        return
    for finding in error.findings:
        place = placed(table, finding.steps, finding.kind)
        where = ".".join(place.path)
        reading.problems.error(
            place.mark, f"{where}: {finding.message}" if where else finding.message
        )
