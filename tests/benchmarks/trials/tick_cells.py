"""Plugins that fail in the tick of a mission that drives a machine, and how soon it is told."""

import json
import math
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from bounds import Bound, Figure, held

from executive.faults import injector
from executive.mission.options import Options
from executive.mission.run import Run
from executive.supervision.supervisor import supervised
from executive.tree.load import load_mission
from trials.seeing_machine import serve
from trials.supervisor import _FORK, wait_for

MISSION = """
api: 1
mission: swing
plugins:
  robot: {{plugin: wire, model: m545, address: "{address}"}}
  estimation: gnss_imu_filter
  odometry: scan_to_submap
  mapping: voxel_map
  objects: sqlite
  motion: hermite
  monitoring: jaw_slip
watch:  # what a busy computer does not break by itself
  encoders: {{do: stop, after: 3 s}}
  estimate: {{do: stop, after: {estimate_s} s}}
loop: {{late_ticks: 1000, heartbeat_limit: {silent_s} s}}
faults: [{{plugin: {plugin}, verb: {verb}, how: {how}, node: ScanSwing, after: 1 s}}]
trees:
  main:
    sequence:
      - {{run: Localise, timeout: 30 s}}
      - reactive_sequence:
          - {{optional: true, do: {{check: NoStoneLeft}}}}
          - {{run: ScanSwing, with: {{angle: 40 deg, duration: 4 s}}}}
"""
TRIES = 4
# How long loop and executive may be silent [s]: the defaults where the supervisor is what notices,
# elsewhere so long that a busy computer does not end the mission before its fault.
SILENT_S = {"hang": (0.2, 0.3), "late": (0.2, 0.3)}
ELSEWHERE_S = (2.0, 3.0)
# How long the estimate may be bad [s]: it is what notices readings that are refused.
ESTIMATE_S = {("robot", "read"): 0.05}
HARMLESS = ("late", "nan", "wrong_type")  # where nothing uses the answer
LONGEST_S = 60.0  # of a mission


def measured(verbs: Sequence[str], hows: Sequence[str], runners: Sequence[str]) -> list[Figure]:
    """Try all cells; return how many came out wrong, and the longest time of each fault.

    A cell whose mission ended before its fault, in every try, has no verdict.
    """
    longest, wrong, undrawn, count = dict.fromkeys(hows, 0.0), 0, 0, 0
    for verb in verbs:
        for how in hows:
            found = [trial(*verb.split("."), how, runner) for runner in runners]
            undrawn += sum(ms is not None and math.isnan(ms) for ms, _ in found)
            for took_ms, why in (one for one in found if one[0] is None or not math.isnan(one[0])):
                is_well = took_ms is not None or (how in HARMLESS and why == "success: ")
                took_ms = took_ms or 0.0
                longest[how] = max(longest[how], took_ms)
                wrong += not (is_well and took_ms <= bound_of(how).must)
            count += len(found)
            told = "; ".join(f"{'' if ms is None else f'{ms:.0f} ms '}{why}" for ms, why in found)
            print(f"{verb} {how}: {told}", flush=True)
    return [
        held("cells that came out wrong", wrong, Bound(0), f"{wrong} of {count - undrawn}"),
        held("cells without a verdict", undrawn, Bound(0), f"{undrawn} of {count}"),
        *(
            held(f"{how}: until the machine is told, longest [ms]", ms, bound_of(how))
            for how, ms in longest.items()
        ),
    ]


def bound_of(how: str) -> Bound:
    """Return the bound on the time until the machine is told [ms]; the supervisor has its own."""
    return Bound(300.0 if how in ("hang", "late") else 200.0)


def trial(plugin: str, verb: str, how: str, runner: str) -> tuple[float | None, str]:
    """Return after how long the machine was told [ms], and why; None if it never was.

    A mission that ends before its fault, as on a computer that is too busy, is tried again.
    """
    for _ in range(TRIES):
        found = attempt(plugin, verb, how, runner)
        if found[0] is None or not math.isnan(found[0]):
            break
    return found


def attempt(plugin: str, verb: str, how: str, runner: str) -> tuple[float | None, str]:
    """Run a mission; the time is NaN if it ended before the fault."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        acted, told, ended = folder / "acted", folder / "told", folder / "ended"
        address = f"unix:{name}/m"
        loop_s, executive_s = SILENT_S.get(how, ELSEWHERE_S)
        serving = _FORK.Process(target=serve, args=(address, executive_s, told))
        serving.start()
        wait_for(folder / "m")
        mission = folder / "mission.yaml"
        cell = {"plugin": plugin, "verb": verb, "how": how}
        limits = {"silent_s": loop_s, "estimate_s": ESTIMATE_S.get((plugin, verb), 3.0)}
        text = MISSION.format(address=address, **limits, **cell)
        mission.write_text(text, encoding="utf-8")
        driving = _FORK.Process(target=drive, args=(mission, runner, acted, ended))
        driving.start()
        try:
            wait_for_one(told, ended)
            if told.exists() and "connection ended" in told.read_text(encoding="utf-8"):
                driving.join(LONGEST_S)  # it has died, or the mission is over
        finally:
            with suppress(ProcessLookupError):  # it has ended
                os.killpg(driving.pid, signal.SIGKILL)
            driving.join()
            serving.terminate()
            serving.join()
        if ended.exists() and ended.read_text(encoding="utf-8").startswith("success"):
            return None, ended.read_text(encoding="utf-8")
        found: dict[str, Any] = json.loads(told.read_text(encoding="utf-8"))
        since_s = float(acted.read_text(encoding="utf-8")) if acted.exists() else float("nan")
        return 1e3 * (found["told_s"] - since_s), found["reason"][:60]


def wait_for_one(*paths: Path) -> None:
    """Wait until one of some files is there."""
    limit_s = time.monotonic() + LONGEST_S
    while not any(path.exists() for path in paths):
        if time.monotonic() > limit_s:
            raise TimeoutError(f"none of {[path.name for path in paths]}")
        time.sleep(0.005)


def drive(mission: Path, runner: str, acted: Path, ended: Path) -> None:
    """Run the mission under a supervisor, in a process group of their own."""
    os.setpgid(0, 0)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    sys.exit(supervised(lambda: run(mission, runner, acted, ended), lambda _: None))


def run(mission: Path, runner: str, acted: Path, ended: Path) -> int:
    """Run the mission; note when its fault acts, and how the mission ends."""
    own = injector.misbehave

    def noted(how: str, delay_s: float, call: Callable[[], Any]) -> Any:
        if not acted.exists():
            acted.write_text(str(time.monotonic()), encoding="utf-8")
        return own(how, delay_s, call)

    injector.misbehave = noted
    options = Options(run_dir=mission.with_suffix(""), real_time=True, runner=runner)
    result = Run(load_mission(str(mission)), options).execute(lambda _: None)
    ended.with_suffix(".part").write_text(f"{result.report.outcome}: {result.report.reason}")
    ended.with_suffix(".part").rename(ended)
    return result.exit_status
