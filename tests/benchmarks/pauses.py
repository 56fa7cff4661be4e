"""Pauses at random ticks of a mission without physics: does it go on as if nothing had been?

    python tests/benchmarks/pauses.py --pauses 200

Each run is paused once, at a random tick, for 5 s to 10 min of machine time, and compared with one
that is not. A run is broken if it ends otherwise, or if its journal differs in more than the
pause. With `--held` the machine's time stands still once the machine is at rest, as it does in
lock-step; without it the machine's time goes on, as on a real machine.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

from executive.clock import SimulatedClock
from executive.events.mission import EstimatorStatusChanged, PauseEnded, PhaseChanged
from executive.journal import read_journal
from executive.mission import run as run_module
from executive.mission.mission import Mission
from executive.mission.run import Options, Run
from executive.tree.load import load_mission

MISSION = """
api: 1
mission: swings
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
trees:
  main:
    sequence:
      - wait: 0.2 s
      - timeout: 20 s
        do:
          run: ScanSwing
          with: {angle: 40 deg, duration: 5 s}
      - wait: 1 s
      - {run: OpenGripper, timeout: 10 s}
"""
TICK_S, SHORTEST_S, LONGEST_S = 0.05, 5.0, 600.0


class GoingOn(SimulatedClock):
    """Lock-step, but the machine's time goes on for as long as a pause lasts."""

    stands_at_rest = False  # type: ignore[assignment]


class PauseOnce:
    """Pauses at a tick, for a machine time."""

    def __init__(self, tick: int, lasts_s: float) -> None:
        self.tick, self.lasts_s = tick, lasts_s
        self.count = 0
        self.until_s: float | None = None
        self.polls = 0

    def __call__(self, mission: Mission) -> None:
        self.count += 1
        if self.count == self.tick:
            self.until_s = mission.clock.machine_s() + self.lasts_s
            mission.toggle_pause()
        elif self.until_s is not None:
            is_held = mission.pause.is_still
            self.polls += is_held
            if self.polls > 1 or mission.clock.machine_s() >= self.until_s:
                self.until_s = None
                mission.toggle_pause()


def story(folder: Path) -> list[tuple[object, ...]]:
    """Return what happened but for the pause: tick, time, node, kind and fields.

    The estimator lives by the measurements, which go on in a pause: its status is left out.
    """
    return [
        (entry.tick, entry.time_s, entry.node, entry.kind, entry.event.payload())
        for entry in read_journal(folder / "journal.jsonl")
        if not isinstance(entry.event, PhaseChanged | PauseEnded | EstimatorStatusChanged)
    ]


def difference(undisturbed: list[tuple[object, ...]], paused: list[tuple[object, ...]]) -> str:
    """Return the first difference; empty for none."""
    for before, after in zip(undisturbed, paused, strict=False):
        if before != after:
            return f"{before[:4]} became {after[:4]}"
    more = len(paused) - len(undisturbed)
    return f"{more:+d} lines" if more else ""


def main() -> None:
    """Run, compare, and say how many were broken."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pauses", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--held", action="store_true")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    if not options.held:
        run_module.SimulatedClock = GoingOn  # type: ignore[misc]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swings.yaml"
        path.write_text(MISSION)

        def run(name: str, pause: PauseOnce | None) -> tuple[str, list[tuple[object, ...]]]:
            made = Run(load_mission(str(path)), Options(run_dir=Path(folder) / name))
            result = made.execute(pause or (lambda mission: None))
            return result.report["outcome"], story(result.folder.path)

        outcome, undisturbed = run("undisturbed", None)
        last = int(undisturbed[-1][0])  # type: ignore[call-overload]
        broken = 0
        for number in range(options.pauses):
            tick = int(rng.integers(1, last))
            lasts_s = float(np.exp(rng.uniform(np.log(SHORTEST_S), np.log(LONGEST_S))))
            ended, found = run(f"pause{number}", PauseOnce(tick, lasts_s))
            reason = "" if ended == outcome else f"{outcome} became {ended}"
            reason = reason or difference(undisturbed, found)
            broken += bool(reason)
            if reason:
                print(f"tick {tick}, {lasts_s:.0f} s: {reason}", flush=True)
        print(f"{broken} broken of {options.pauses} ({outcome}, {last} ticks)", flush=True)
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
