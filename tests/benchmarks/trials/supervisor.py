"""Failures of the executive's loop, and how soon the machine behind the wire is told to stop."""

import itertools
import json
import multiprocessing as mp
import os
import signal
import sys
import tempfile
import threading
import time
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held

from executive.machine.machine import load_machine
from executive.messages.command import Follow
from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory
from executive.registry import load, settings_of
from executive.supervision.beacon import beacon
from executive.supervision.supervisor import supervised
from executive.wire.address import Address
from executive.wire.machine_server import MachineServer

BOUND_MS = Bound(300)
TICK_S = 0.05
HEARTBEAT_LIMIT_S = 0.2  # the default of `loop.heartbeat_limit`
_FAILS_AT = 14  # tick; the cabin turns since the sixth
_FORK = mp.get_context("fork")  # imports are done; no thread runs yet


def machine(address: str, silence_s: float, note: Path) -> None:
    """Serve a kinematic machine that notes when it is told to stop, and why."""
    plugin = load("robot", "kinematic")
    robot = plugin(settings_of("robot", "kinematic")(), load_machine("m545"))
    server = MachineServer(robot, "m545", Address.parse(address), silence_s)
    noting(robot, note)
    signal.signal(signal.SIGTERM, lambda *_: setattr(server, "is_ended", True))
    server.run()


def noting(robot: Any, note: Path) -> None:
    """Let a robot write down when it is told to stop for the first time, and why."""
    stop = robot.safe_stop

    def noted(reason: str) -> None:
        stop(reason)
        if not note.exists():
            told = {"told_s": time.monotonic(), "reason": reason}
            note.with_suffix(".part").write_text(json.dumps(told), encoding="utf-8")
            note.with_suffix(".part").rename(note)

    robot.safe_stop = noted


def swing(start: float) -> Follow:
    """Return a turn of the cabin that takes 20 s."""
    s = np.linspace(0.0, 1.0, 41)
    blend, rate = s**2 * (3 - 2 * s), 6 * s * (1 - s) / 20.0
    columns = (start + 3.0 * blend)[:, None], 3.0 * rate[:, None]
    return Follow(JointTrajectory(("J_TURN",), 20.0 * s, *columns))


def executive(kind: str, phase_s: float, address: str, note: Path) -> int:
    """Drive the machine as the mission's loop does; fail so long after a sign of life [s]."""
    robot = load("robot", "wire")(settings_of("robot", "wire")(address=address, answer_limit=5.0))
    robot.start()
    begun_s, page = time.monotonic(), beacon()
    page.name(machine=address)
    page.watch(HEARTBEAT_LIMIT_S, HEARTBEAT_LIMIT_S)
    for tick in itertools.count(1):
        found = [o for o in robot.read(time.monotonic() - begun_s) if isinstance(o, JointSample)]
        if found:
            page.see_joints()
        if tick == 6:
            robot.command(swing(found[-1].of("J_TURN")[0]))
        page.beat()
        if tick == _FAILS_AT:
            time.sleep(phase_s)
            note.write_text(str(time.monotonic()), encoding="utf-8")
            fail(kind)
        time.sleep(max(0.0, begun_s + tick * TICK_S - time.monotonic()))
    return 0


def fail(kind: str) -> None:
    """Fail in one way; none of them returns."""
    if kind == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if kind == "gil":
        deque(itertools.repeat(0), maxlen=0)
    if kind == "read":
        threading.Event().wait()
    while True:
        pass


def drive(kind: str, phase_s: float, address: str, note: Path) -> None:
    """Drive under a supervisor, in a process group of their own."""
    os.setpgid(0, 0)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    sys.exit(supervised(lambda: executive(kind, phase_s, address, note), lambda _: None))


def trial(kind: str, phase_s: float, silence_s: float) -> tuple[float, str]:
    """Return how long the machine was not told [s], and who told it."""
    with tempfile.TemporaryDirectory() as folder:
        address, failed, told = f"unix:{folder}/m", Path(folder, "failed"), Path(folder, "told")
        serving = _FORK.Process(target=machine, args=(address, silence_s, told))
        serving.start()
        wait_for(Path(folder, "m"))
        driving = _FORK.Process(target=drive, args=(kind, phase_s, address, failed))
        driving.start()
        try:
            wait_for(failed)
            wait_for(told)
        finally:
            os.killpg(driving.pid, signal.SIGKILL)
            driving.join()
            serving.terminate()
            serving.join()
        found = json.loads(told.read_text(encoding="utf-8"))
        who = "supervisor" if found["reason"].startswith("supervisor") else "machine"
        return found["told_s"] - float(failed.read_text(encoding="utf-8")), who


def wait_for(path: Path) -> None:
    """Wait until a file is there."""
    limit_s = time.monotonic() + 60
    while not path.exists():
        if time.monotonic() > limit_s:
            raise TimeoutError(f"{path.name}: not within 60 s")
        time.sleep(0.005)


def measured(kinds: Sequence[str], trials: int, silence_s: float, seed: int) -> list[Figure]:
    """Do the kinds of failure in turn; return the longest time of each."""
    found: dict[str, list[tuple[float, str]]] = {kind: [] for kind in kinds}
    phases = np.random.default_rng(seed).uniform(0.0, TICK_S, trials)
    for number, phase_s in enumerate(phases):
        kind = kinds[number % len(kinds)]
        found[kind].append(trial(kind, float(phase_s), silence_s))
    return [_figure(kind, times) for kind, times in found.items() if times]


def _figure(kind: str, times: Sequence[tuple[float, str]]) -> Figure:
    ms = [1e3 * seconds for seconds, _ in times]
    by = [who for _, who in times].count("supervisor")
    words = (
        f"{max(ms):.0f} (median {np.median(ms):.0f}, n = {len(ms)}; told by the supervisor {by}, "
        f"by the machine itself {len(ms) - by})"
    )
    return held(f"{kind}: until the machine is told, longest [ms]", max(ms), BOUND_MS, words)
