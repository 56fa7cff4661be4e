"""Pauses of a mission without physics, each compared with the undisturbed run."""

import tempfile
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held

from executive.clock import SimulatedClock
from executive.events.mission import EstimatorStatusChanged, PauseEnded, PhaseChanged
from executive.journal import read_journal
from executive.mission import run as run_module
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.run import Run
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
SHORTEST_S, LONGEST_S = 5.0, 600.0
NONE = Bound(0)

Story = list[tuple[object, ...]]


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


def story(folder: Path) -> Story:
    """Return what happened but for the pause: tick, time, node, kind and fields.

    The estimator lives by the measurements, which go on in a pause: its status is left out.
    """
    return [
        (entry.tick, entry.time_s, entry.node, entry.kind, entry.event.payload())
        for entry in read_journal(folder / "journal.jsonl")
        if not isinstance(entry.event, PhaseChanged | PauseEnded | EstimatorStatusChanged)
    ]


def difference(undisturbed: Story, paused: Story) -> str:
    """Return the first difference; empty for none."""
    for before, after in zip(undisturbed, paused, strict=False):
        if before != after:
            return f"{before[:4]} became {after[:4]}"
    more = len(paused) - len(undisturbed)
    return f"{more:+d} lines" if more else ""


def run(mission: Path, folder: Path, pause: PauseOnce | None) -> tuple[str, Story]:
    """Run the mission; return its outcome, and what happened."""
    made = Run(load_mission(str(mission)), Options(run_dir=folder))
    result = made.execute(pause or (lambda mission: None))
    return result.report.outcome, story(result.folder.path)


def measured(pauses: int, seed: int, is_held: bool) -> list[Figure]:
    """Run once undisturbed and then with pauses; return how many runs were broken."""
    rng = np.random.default_rng(seed)
    if not is_held:
        run_module.SimulatedClock = GoingOn  # type: ignore[misc]
    ends = differ = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swings.yaml"
        path.write_text(MISSION, encoding="utf-8")
        outcome, undisturbed = run(path, Path(folder) / "undisturbed", None)
        last = int(undisturbed[-1][0])  # type: ignore[call-overload]
        for number in range(pauses):
            tick = int(rng.integers(1, last))
            lasts_s = float(np.exp(rng.uniform(np.log(SHORTEST_S), np.log(LONGEST_S))))
            pause = PauseOnce(tick, lasts_s)
            ended, found = run(path, Path(folder) / f"pause{number}", pause)
            change = difference(undisturbed, found)
            ends += ended != outcome
            differ += bool(change)
            if ended != outcome or change:
                told = f"{outcome}, then {ended}; {change}"
                print(f"tick {tick}, {lasts_s:.0f} s: {told}", flush=True)
    return [
        Figure("the undisturbed run", f"{outcome}, {last} ticks"),
        held("paused runs that end otherwise", ends, NONE, f"{ends} of {pauses}"),
        held("journals that differ in more than the pause", differ, NONE, f"{differ} of {pauses}"),
    ]
