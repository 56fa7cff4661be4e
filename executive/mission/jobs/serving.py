"""The worker's end of a worker process: makes a plugin, and answers one call after another."""

import ctypes
import faulthandler
import os
import pickle
import signal
from collections.abc import Mapping
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from pathlib import Path
from typing import Any

from executive.clock import wall_s
from executive.confined.memory import MemoryLimit
from executive.errors import RobotError
from executive.interfaces.plugin import Plugin
from executive.machine.machine import Machine
from executive.mission.assembly import Assembly, Selections, assemble_for, selected_plugins
from executive.mission.fault import REMOTE, fault_of
from executive.mission.garbage import RETURN_PERIOD_S, return_free_memory, spare_what_is_made
from executive.mission.jobs.call import Address, CallError, NotPortableError, VerbCall

_SIGNAL_AT_DEATH_OF_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)


def dumped(value: object) -> bytes:
    """Return a value's pickle, as processes of one mission send it to each other."""
    return bytes(ForkingPickler.dumps(value))


def serve(
    connection: Connection,
    capability: str,
    selections: Selections,
    machine: Machine,
    seed: int,
    memory_bytes: int,
    stack: Path,
) -> None:
    """Answer calls until the connection is closed; the first thing sent tells of the start."""
    _live_and_die_with_the_mission()
    with stack.open("w", encoding="utf-8") as dump:
        faulthandler.enable(dump)
        faulthandler.register(signal.SIGUSR1, dump, all_threads=False)
        assembly = _started(connection, selections, machine, seed)
        if assembly is None:
            return
        plugin = assembly.plugins[capability]
        MemoryLimit(memory_bytes)
        spare_what_is_made()
        returned_s = wall_s()
        try:
            # Only now: what a worker does to get ready takes no time of its first call's limit.
            connection.send_bytes(pickle.dumps(None))
            while True:
                call: VerbCall = pickle.loads(connection.recv_bytes())
                connection.send_bytes(_answer(call, plugin, capability, assembly))
                if wall_s() - returned_s > RETURN_PERIOD_S:
                    return_free_memory()
                    returned_s = wall_s()
        except (EOFError, OSError):
            assembly.close()


def _live_and_die_with_the_mission() -> None:
    """Leave Ctrl-C to the mission, and end when the mission's process has ended, however it did."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    ctypes.CDLL(None).prctl(_SIGNAL_AT_DEATH_OF_PARENT, signal.SIGKILL)
    if os.getppid() == 1:  # it ended before that call
        os._exit(1)


def _started(
    connection: Connection, selections: Selections, machine: Machine, seed: int
) -> Assembly | None:
    plugins: Mapping[str, Any] = {}
    try:
        assembly = assemble_for(machine, selections, seed)
        plugins = assembly.plugins
        assembly.start()
    except (Exception, SystemExit) as error:
        connection.send_bytes(pickle.dumps(_portable(error, plugins)))
        return None
    return assembly


def _answer(call: VerbCall, plugin: Plugin, capability: str, assembly: Assembly) -> bytes:
    """Return the pickled pair: whether it is an error, and the value or the error."""
    try:
        answer = call.of(plugin)
    except Exception as error:
        return pickle.dumps((True, _portable(error, assembly.plugins)))
    try:
        return dumped((False, answer))
    except Exception as error:  # whatever a class does when it is pickled
        name = next(name for _, name, one in selected_plugins(assembly.plugins) if one is plugin)
        address = Address.of(capability, name, plugin, call.verb)
        reason = f"its answer cannot be sent: {type(error).__name__}: {error}"
        failure: CallError = address.error(NotPortableError, reason)
        return pickle.dumps((True, failure))


def _portable(error: BaseException, plugins: Mapping[str, Any]) -> BaseException:
    """Return an error that can be sent, with the fault that it is: its frames cannot be sent."""
    fault = fault_of(error, plugins)
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # whatever an exception class of a plugin does when it is copied
        error = RobotError(f"{type(error).__name__}: {error}")
    if isinstance(error, SystemExit):
        error = RobotError(f"it called sys.exit({error.code!r})")
    setattr(error, REMOTE, fault)
    return error
