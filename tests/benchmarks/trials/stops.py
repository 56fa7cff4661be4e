"""Stops by Ctrl-C at random moments of a swing on the wall clock, and the time that they take."""

import os
import signal
import tempfile
import threading
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.robot.kinematic import KinematicRobot

from executive.clock import wall_s
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

MISSION = """
api: 1
mission: swing
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
loop: {runner: thread, late_ticks: 1000}
trees:
  main:
    sequence:
      - wait: 0.2 s
      - {run: ScanSwing, with: {angle: 60 deg, duration: 20 s}}
"""
P99_MS, WORST_MS, NONE = Bound(60.0), Bound(150.0), Bound(0)
LATEST_S = 1.0


class Stopper:
    """Presses Ctrl-C at a random moment after the loop has begun, and notes when."""

    def __init__(self, after_s: float) -> None:
        self.after_s = after_s
        self.pressed_s = 0.0
        self.has_begun = False

    def __call__(self, mission: Mission) -> None:
        if not self.has_begun:
            self.has_begun = True
            threading.Timer(self.after_s, self.press).start()

    def press(self) -> None:
        """Send the signal."""
        self.pressed_s = wall_s()
        os.kill(os.getpid(), signal.SIGINT)


def watched() -> list[float]:
    """Let the robot's `stop` note its times [s]; return where they are noted."""
    stopped: list[float] = []
    stop = KinematicRobot.stop

    def noted(robot: KinematicRobot) -> None:
        stopped.append(wall_s())
        stop(robot)

    KinematicRobot.stop = noted  # type: ignore[method-assign]
    return stopped


def measured(stops: int, seed: int) -> list[Figure]:
    """Run and stop so many times; return the times until the stop is commanded."""
    rng, stopped = np.random.default_rng(seed), watched()
    taken_ms, wrong = [], 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swing.yaml"
        path.write_text(MISSION, encoding="utf-8")
        for number in range(stops):
            stopped.clear()
            stopper = Stopper(float(rng.uniform(0.0, LATEST_S)))
            options = Options(run_dir=Path(folder) / str(number), real_time=True)
            report = Run(load_mission(str(path)), options).execute(stopper).report
            if report.outcome != "stopped":
                wrong += 1
                print(f"run {number}: {report.outcome}: {report.reason}", flush=True)
                continue
            taken_ms.append(1e3 * (stopped[0] - stopper.pressed_s))
    p50, p99, worst = np.percentile(taken_ms or [np.nan], [50, 99, 100])
    return [
        Figure("until the stop is commanded, median [ms]", f"{p50:.1f} (n = {len(taken_ms)})"),
        held("until the stop is commanded, 99 % [ms]", p99, P99_MS, f"{p99:.1f}"),
        held("until the stop is commanded, worst [ms]", worst, WORST_MS, f"{worst:.1f}"),
        held("runs that end otherwise than stopped", wrong, NONE, f"{wrong} of {stops}"),
    ]
