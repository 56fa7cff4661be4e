"""Ctrl-C at random moments of a mission on the wall clock: how soon is the stop commanded?

    python tests/benchmarks/stops.py --stops 1000

A thread sends SIGINT to this process at a random moment of a swing. The time until the robot's
`stop` is called counts; bounds are 60 ms at the 99th percentile and 150 ms at worst. Each run must
end as `stopped`.
"""

import argparse
import os
import signal
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
from executive_plugins.robot.kinematic import KinematicRobot

from executive.clock import wall_s
from executive.mission.mission import Mission
from executive.mission.run import Options, Run
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
P99_MS, WORST_MS, LATEST_S = 60.0, 150.0, 1.0


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


def main() -> None:
    """Run, measure, and compare with the bounds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stops", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    stopped: list[float] = []
    stop = KinematicRobot.stop

    def noted(robot: KinematicRobot) -> None:
        stopped.append(wall_s())
        stop(robot)

    KinematicRobot.stop = noted  # type: ignore[method-assign]
    taken_ms, wrong = [], 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swing.yaml"
        path.write_text(MISSION)
        for number in range(options.stops):
            stopped.clear()
            stopper = Stopper(float(rng.uniform(0.0, LATEST_S)))
            made = Run(
                load_mission(str(path)), Options(run_dir=Path(folder) / str(number), real_time=True)
            )
            report = made.execute(stopper).report
            if report["outcome"] != "stopped":
                wrong += 1
                print(f"run {number}: {report['outcome']}: {report['reason']}", flush=True)
                continue
            taken_ms.append(1e3 * (stopped[0] - stopper.pressed_s))
    p50, p99, worst = np.percentile(taken_ms, [50, 99, 100])
    print(
        f"{len(taken_ms)} stops: median {p50:.1f} ms, p99 {p99:.1f} ms, worst {worst:.1f} ms; "
        f"{wrong} ended otherwise"
    )
    sys.exit(1 if wrong or p99 > P99_MS or worst > WORST_MS else 0)


if __name__ == "__main__":
    main()
