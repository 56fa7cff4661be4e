"""Installs the toy's plugins, writes its mission, and judges how the stones stand in the end."""

import shutil
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
CAPABILITIES = {
    "robot": "ToyRobot",
    "mapping": "ToyMap",
    "segmentation": "ToySegmenter",
    "grasping": "ToyGrasps",
    "placing": "ToyPlaces",
    "motion": "ToyMotion",
}
MISSION = """
api: 1
mission: toy
plugins:
  robot: {plugin: toy, model: m545}
  estimation: gnss_imu_filter
  mapping: toy
  segmentation: toy
  objects: sqlite
  motion: toy
  grasping: toy
  placing: toy
  monitoring: jaw_slip
trees:
  main:
    sequence:
      - run: Localise
        timeout: 60 s
      - run: Segment
      - run: FindSlots
        with: {count: 3}
      - set: {moved: 0}
      - loop: {until: NoStoneLeft, max: 8}
        do:
          sequence:
            - check: SelectLargest
            - check: FindFreeSlots
            - retry: 3
              do: {call: move}
              on_failure: {run: Segment}
            - set: {moved: "{moved} + 1"}
      - check: "{moved} == 2"
  move:
    in: {stone: int, free_slots: "list[Slot]"}
    sequence:
      - run: PlanGrasp
      - retry: 2
        do:
          sequence:
            - run: PlanPick
            - run: OpenGripper
            - run: ExecuteTrajectory
            - run: CloseGripper
        on_failure: {run: OpenGripper}
      - sequence:
          - run: PlanPlacement
          - fallback:
              - reactive_sequence:
                  - check: DetectSlip
                  - run: ExecuteTrajectory
              - check: HasArrived
        on_failure:
          sequence:
            - optional: true
              do:
                sequence:
                  - check: IsHolding
                  - run: PlanSetDown
                  - run: ExecuteTrajectory
            - run: ReleaseStone
      - run: ReleaseStone
      - optional: true
        do:
          sequence:
            - run: PlanRetreat
            - run: ExecuteTrajectory
"""


def install(folder: Path) -> Path:
    """Write package and mission into a folder that goes on the path; return the mission."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(HERE / "toy_plugins.py", folder)
    info = folder / "toy.egg-info"
    info.mkdir(exist_ok=True)
    (info / "PKG-INFO").write_text("Name: toy\nVersion: 1\n", encoding="utf-8")
    groups = [f"[executive.{c}.v1]\ntoy = toy_plugins:{name}\n" for c, name in CAPABILITIES.items()]
    (info / "entry_points.txt").write_text("\n".join(groups), encoding="utf-8")
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    mission = folder / "toy.yaml"
    mission.write_text(MISSION, encoding="utf-8")
    return mission


def complaints(robot, stones, report) -> list[str]:
    """Return what is wrong in the end: lost, doubled, dropped or misplaced stones; none if all is
    well.
    """
    from toy_plugins import SLOTS, STONES

    found = []
    if report.outcome != "success":
        found.append(f"{report.outcome}: {report.reason}")
    if len(stones) != len(STONES):
        found.append(f"the database has {len(stones)} stones for {len(STONES)}")
    if robot.held >= 0 or any(stone.state.value == "held" for stone in stones):
        found.append("a stone is still held")
    if robot.falls:
        found.append(f"{robot.falls} stones fell")
    gaps = np.linalg.norm(robot.stones[:, None, :2] - SLOTS[None, :, :2], axis=2)
    if (gaps.min(axis=1) > 0.1).any() or len(set(gaps.argmin(axis=1))) < len(STONES):
        found.append(f"stones are not each on a slot of its own: {robot.stones.round(2).tolist()}")
    for stone in stones:
        if np.linalg.norm(robot.stones - stone.centroid_map, axis=1).min() > 0.1:
            found.append(f"stone {stone.id} is not where the database has it")
    counts = report.counts
    if (counts.picks, counts.placed) != (len(STONES), len(STONES)):
        found.append(f"the report tells of {counts.placed} of {counts.picks} picks placed")
    return found
