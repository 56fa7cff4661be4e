"""Runs that are killed or frozen as a whole, and what becomes of their machines."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held

from executive.machine.machine import load_machine
from executive.mission.machine_process import listener_at
from executive.supervision.link import MachineLink

MISSION = """
api: 1
mission: swing
plugins:
  robot: {plugin: kinematic, model: m545, noise: true}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
watch:  # what a busy computer does not break by itself
  encoders: {do: stop, after: 3 s}
loop: {late_ticks: 1000}
trees:
  main:
    sequence:
      - {run: Localise, timeout: 30 s}
      - {run: ScanSwing, with: {angle: 120 deg, duration: 40 s}}
"""
KINDS = {"kill": signal.SIGKILL, "freeze": signal.SIGSTOP}
SILENCE_MS = 300.0
REPORT_MS = 20.0  # between two reports of the machine
MOVING, LONGEST_S = 0.05, 60.0


def measured(trials: int, seed: int) -> list[Figure]:
    """Try each kind in turn; return the longest times until the stop and until rest."""
    rng = np.random.default_rng(seed)
    stops, rests = dict.fromkeys(KINDS, 0.0), dict.fromkeys(KINDS, 0.0)
    for number in range(trials):
        how = list(KINDS)[number % len(KINDS)]
        stop_ms, rest_ms, why = trial(how, float(rng.uniform(0.0, 2.0)))
        print(f"{how}: stops after {stop_ms:.0f} ms, stands {rest_ms:.0f} ms later: {why}")
        stops[how], rests[how] = max(stops[how], stop_ms), max(rests[how], rest_ms)
    braking_ms = 1e3 * load_machine("m545").stop_s(["J_TURN"]) + REPORT_MS
    told = Bound(SILENCE_MS + REPORT_MS)
    return [
        *(
            held(f"{how}: until the machine stops, longest [ms]", ms, told)
            for how, ms in stops.items()
        ),
        *(
            held(f"{how}: from then until it stands, longest [ms]", ms, Bound(braking_ms))
            for how, ms in rests.items()
        ),
    ]


def trial(how: str, after_s: float) -> tuple[float, float, str]:
    """Return when the stop began, how long it took [ms], and what the machine says of it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "mission.yaml").write_text(MISSION, encoding="utf-8")
        words = ["run", "mission.yaml", "--real-time", "--run-dir=run", "--runner=thread"]
        with subprocess.Popen(
            [sys.executable, "-m", "executive.commands.entry", *words, "--quiet"],
            cwd=folder,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        ) as process:
            link, address = MachineLink(), folder / "run" / "machine.address"
            awaited(lambda: address.is_file() and address.read_text().strip())
            where = address.read_text().strip()
            try:
                awaited(lambda: report_of(link, where).get("speed", 0.0) > MOVING)
                time.sleep(after_s)
                report_of(link, where)
                os.killpg(process.pid, KINDS[how])
                begun_s = time.monotonic()
                why = awaited(lambda: report_of(link, where).get("latched"))
                stopped_s = time.monotonic()
                awaited(lambda: report_of(link, where)["at_rest"])
                return 1e3 * (stopped_s - begun_s), 1e3 * (time.monotonic() - stopped_s), why
            finally:
                link.close()
                os.killpg(process.pid, signal.SIGKILL)
                machine = listener_at(where)
                if machine:
                    os.kill(machine, signal.SIGTERM)


def report_of(link: MachineLink, address: str) -> dict[str, Any]:
    link.keep(address)
    return dict(link.report)


def awaited(found: Callable[[], Any]) -> Any:
    """Return what is found at last."""
    until_s = time.monotonic() + LONGEST_S
    while time.monotonic() < until_s:
        value = found()
        if value:
            return value
        time.sleep(0.002)
    raise TimeoutError("the run has not come so far")
