"""The simulated machine of a run on the wall clock: in a process of its own.

It has its own clock and outlives the executive: when that hangs or dies, the machine comes to rest
by itself. It ends on its own once no executive has been there for a while.
"""

import os
import secrets
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from executive import registry
from executive.clock import wall_s
from executive.errors import ConfigError, RobotError
from executive.interfaces.robot import RobotSettings
from executive.mission.machine_folder import MachineFolder
from executive.tree.language import MissionFile
from executive.tree.selection import Selection
from executive.wire.address import Address

SILENCE_S = 0.3  # after which a machine without an executive stops: docs/robot_wire.md
_BEYOND_HEARTBEAT = 1.5  # the supervisor stops a silent executive's machine first
_LONGEST_LIMIT_S = 10.0  # of the wire's settings
_START_S = 120.0  # to build a large site on a busy computer
_END_S = 60.0  # to write the truth of an hour
_LOOK_S = 0.02
_CONNECT_S = 1.0
_INPUT_IS_WRONG = 2  # exit status
_PEER = struct.Struct("3i")  # process, user, group


def lives_apart(description: MissionFile) -> bool:
    """Return whether a mission's machine is a simulated one, which can live elsewhere."""
    settings = description.plugins["robot"][0].settings
    return isinstance(settings, RobotSettings) and settings.is_simulated


def behind_the_wire(description: MissionFile, address: str) -> MissionFile:
    """Return a mission that drives the machine at an address instead of its own."""
    wired = registry.settings_of("robot", "wire")
    robot = description.plugins["robot"][0].settings
    model = robot.model if isinstance(robot, RobotSettings) else ""
    limit_s = min(2 * silence_of(description), _LONGEST_LIMIT_S)
    given = {"address": address, "model": model, "silence_limit": limit_s, "answer_limit": limit_s}
    settings = wired.model_validate(given)
    return replace(
        description, plugins={**description.plugins, "robot": (Selection("wire", settings),)}
    )


def silence_of(description: MissionFile) -> float:
    """Return after which silence of the executive the machine stops by itself [s]."""
    return max(SILENCE_S, _BEYOND_HEARTBEAT * description.loop.heartbeat_limit)


class MachineProcess:
    """Starts and ends the process of one run's machine.

    Attributes:
        address: Where the machine listens: a socket in a folder of this user's own.
    """

    def __init__(self, seed: int, silence_s: float) -> None:
        """Choose the address; nothing is started yet.

        Args:
            seed: Seed of the mission.
            silence_s: The machine stops after such a silence of the executive [s].
        """
        self._seed, self._silence_s = seed, silence_s
        # Not in the run's folder: the path of a socket has at most 107 bytes.
        self._home = Path(tempfile.gettempdir()) / f"machine-{secrets.token_hex(8)}"
        self.address = f"unix:{self._home / 'machine.sock'}"
        self._process: subprocess.Popen[bytes] | None = None

    def start(self, folder: MachineFolder) -> None:
        """Start the machine, and wait until it listens.

        Args:
            folder: What the run's folder holds of the machine.

        Raises:
            ConfigError: If its site cannot be built; the message is the machine's own.
            RobotError: If it ends, or does not listen in time.
        """
        _end_earlier(folder)
        self._home.mkdir(mode=0o700)
        words = [
            *(sys.executable, "-m", "executive.commands.entry", "simulate"),
            *(str(folder.mission), "--seed", str(self._seed)),
            *("--address", self.address, "--silence", f"{self._silence_s:g} s"),
            *("--run-dir", str(folder.path)),
        ]
        with folder.log.open("wb") as log:
            self._process = process = subprocess.Popen(
                words,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=log,
                start_new_session=True,  # Ctrl-C is for the executive, which stops the machine
            )
        folder.address.write_text(self.address + "\n", encoding="utf-8")
        has_begun = _await(
            _START_S, lambda: process.poll() is not None or listener_at(self.address)
        )
        if process.poll() is not None:
            failed = ConfigError if process.returncode == _INPUT_IS_WRONG else RobotError
            raise failed(folder.last_words())
        if not has_begun:
            self.end()
            raise RobotError(f"the simulated machine does not listen after {_START_S:g} s")

    def end(self) -> None:
        """End the machine, which writes its truth first; a second time it does nothing."""
        process, self._process = self._process, None
        if process is not None:
            process.terminate()
            try:
                process.wait(_END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        shutil.rmtree(self._home, ignore_errors=True)


def _end_earlier(folder: MachineFolder) -> None:
    """End the machine of a process that was killed, should it still be there."""
    try:
        address = folder.address.read_text(encoding="utf-8").strip()
    except OSError:
        return
    process = listener_at(address)
    if process:
        os.kill(process, signal.SIGTERM)
        _await(_END_S, lambda: not listener_at(address))


def listener_at(address: str) -> int:
    """Return the number of the process that listens at an address; 0 if none does."""
    try:
        with Address.parse(address).connect(_CONNECT_S) as found:
            peer = found.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _PEER.size)
    except (OSError, ConfigError):
        return 0
    return int(_PEER.unpack(peer)[0])


def _await(limit_s: float, is_done: Callable[[], object]) -> bool:
    until_s = wall_s() + limit_s
    while wall_s() < until_s:
        if is_done():
            return True
        time.sleep(_LOOK_S)  # noqa: TID251 - the mission has not begun, or has ended
    return False
