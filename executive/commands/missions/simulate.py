"""`executive simulate`: a mission's simulated machine, alive in a process of its own."""

import logging
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption, MissionArgument, SeedOption, SetOption
from executive.config import parse_quantity
from executive.errors import ConfigError

if TYPE_CHECKING:
    from executive.interfaces.robot import Robot
    from executive.interfaces.surveying import Survey
    from executive.messages.cloud import Cloud
    from executive.mission.assembly import Selections
    from executive.mission.machine_folder import WorldKeeper
    from executive.wire.machine_server import MachineServer

_SURVEYING = "surveying"
_SWITCH_S = 5e-4  # a survey in a thread holds the machine's steps up for no longer
_KEPT_EVERY_S = 0.5  # of the world's time that a loss of power may cost
_ALONE_S = 60.0  # long enough for an executive that starts, or is resumed in the same world
_SHORTEST_S = 0.05  # a tick: an executive cannot be heard more often


def simulate(
    mission: MissionArgument,
    address: Annotated[
        str, typer.Option(help="Where to listen: unix:PATH or 127.0.0.1:PORT (0: any free port).")
    ] = "127.0.0.1:0",
    set_: SetOption = None,
    seed: SeedOption = 1,
    silence: Annotated[
        str, typer.Option(help="The machine stops when no executive is heard for so long.")
    ] = "0.3 s",
    run_dir: Annotated[
        Path | None,
        typer.Option(
            help="Live for this run alone: leave the state of the world and what really happened "
            "in its folder, and end when no executive has been there for a minute."
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Run a mission's simulated machine on its own.

    The machine keeps its own clock, and `executive run --machine` connects with it. It speaks the
    robot wire (docs/robot_wire.md), and comes to rest by itself when the executive is silent. It
    ends with Ctrl-C.

    Example: executive simulate map_site --address unix:/tmp/machine.sock
    """
    from executive.mission.assembly import assemble, needed_for
    from executive.mission.machine_folder import MachineFolder, WorldKeeper
    from executive.mission.selections import model_of
    from executive.tree.load import load_mission
    from executive.wire.address import Address
    from executive.wire.machine_server import MachineServer, Simulation

    where, silence_s = Address.parse(address), _silence_s(silence)
    description = load_mission(mission, set_ or ())
    if description.plugins["robot"][0].name == "wire":
        raise ConfigError("the robot 'wire' is another process's; choose --set robot.plugin=mujoco")
    model = model_of(description)
    assembly = assemble(needed_for(description.plugins, "robot"), model, seed)
    logging.basicConfig(format="%(message)s", level=logging.WARNING)
    sys.setswitchinterval(_SWITCH_S)
    assembly.start()
    robot = assembly.plugins["robot"]
    keeper = None if run_dir is None else WorldKeeper(MachineFolder(run_dir), robot)
    try:
        simulation = Simulation(
            survey=_surveys(description.plugins, robot),
            begins_s=keeper.restore() if keeper else 0.0,
            tend=_tended(keeper) if keeper else lambda server: None,
        )
        server = MachineServer(robot, model, where, silence_s, simulation)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: setattr(server, "is_ended", True))
        say(f"machine '{model}' listens at {server.address}; Ctrl-C ends it")
        if as_json:
            answer({"address": str(server.address), "model": model, "silence_s": silence_s})
        try:
            server.run()
        finally:
            if keeper is not None:
                _is_kept(lambda: keeper.end(server.time_s), False)
    finally:
        assembly.close()
        if where.path:
            Path(where.path).unlink(missing_ok=True)


def _surveys(
    selections: "Selections", robot: "Robot"
) -> "Callable[[int], Callable[[], Cloud]] | None":
    """Return what surveys the simulated site; None if the mission selects nothing that looks at it.

    Each survey is made by a plugin of its own, which sees a copy of the site. One is started and
    closed at once: what a start compiles or imports is then there before the machine lives.
    """
    import numpy as np

    from executive import registry
    from executive.interfaces.facilities import SurveyedAside

    chosen = next(iter(selections.get(_SURVEYING, ())), None)
    if chosen is None or not isinstance(robot, SurveyedAside):
        return None
    plugin = registry.load(_SURVEYING, chosen.name)
    if registry.dependencies_of(plugin) != ("robot",):
        return None

    first: Survey = plugin(chosen.settings, robot=robot)
    first.start()
    first.close()

    def begin(seed: int) -> "Callable[[], Cloud]":
        site = robot.site_now()

        def survey() -> "Cloud":
            made: Survey = plugin(chosen.settings, robot=site)
            made.start()
            try:
                return made.survey(np.random.default_rng(seed))
            finally:
                made.close()

        return survey

    return begin


def _tended(keeper: "WorldKeeper") -> "Callable[[MachineServer], None]":
    """Return what keeps the world, and ends a machine that nobody drives any more.

    A full disk ends no machine: its executive has to stop it first.
    """
    kept_s, has_failed = -_KEPT_EVERY_S, False

    def tend(server: "MachineServer") -> None:
        nonlocal kept_s, has_failed
        if server.time_s - kept_s >= _KEPT_EVERY_S:
            kept_s = server.time_s
            has_failed = not _is_kept(lambda: keeper.keep(server.time_s), has_failed)
        server.is_ended = server.is_ended or server.alone_s > _ALONE_S

    return tend


def _is_kept(write: "Callable[[], None]", is_told: bool) -> bool:
    """Write the state of the world; tell an error of the disk, unless that was told before."""
    try:
        write()
    except OSError as error:
        if not is_told:
            logging.getLogger(__name__).warning("the world cannot be kept: %s", error.strerror)
        return False
    return True


def _silence_s(text: str) -> float:
    try:
        found = parse_quantity(text if not _is_number(text) else float(text), "time")
    except ValueError as error:
        raise ConfigError(f"--silence: {error}") from error
    if found < _SHORTEST_S:
        raise ConfigError(f"--silence: at least {_SHORTEST_S} s, got {text}")
    return found


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
