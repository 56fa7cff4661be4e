"""`executive simulate`: a mission's simulated machine, alive in a process of its own."""

import logging
import signal
from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption, MissionArgument, SeedOption, SetOption
from executive.config import parse_quantity
from executive.errors import ConfigError

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
    as_json: JsonOption = False,
) -> None:
    """Run a mission's simulated machine on its own.

    The machine keeps its own clock, and `executive run --machine` connects with it. It speaks the
    robot wire (docs/robot_wire.md), and comes to rest by itself when the executive is silent. It
    ends with Ctrl-C.

    Example: executive simulate map_site --address unix:/tmp/machine.sock
    """
    from executive.mission.assembly import assemble, needed_for
    from executive.mission.selections import model_of
    from executive.tree.load import load_mission
    from executive.wire.address import Address
    from executive.wire.machine_server import MachineServer

    where, silence_s = Address.parse(address), _silence_s(silence)
    description = load_mission(mission, set_ or ())
    if description.plugins["robot"][0].name == "wire":
        raise ConfigError("the robot 'wire' is another process's; choose --set robot.plugin=mujoco")
    model = model_of(description)
    assembly = assemble(needed_for(description.plugins, "robot"), model, seed)
    logging.basicConfig(format="%(message)s", level=logging.WARNING)
    assembly.start()
    try:
        server = MachineServer(assembly.plugins["robot"], model, where, silence_s)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: setattr(server, "is_ended", True))
        say(f"machine '{model}' listens at {server.address}; Ctrl-C ends it")
        if as_json:
            answer({"address": str(server.address), "model": model, "silence_s": silence_s})
        server.run()
    finally:
        assembly.close()
        if where.path:
            Path(where.path).unlink(missing_ok=True)


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
