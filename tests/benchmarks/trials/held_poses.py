"""Poses of held stones by the database and by the simulator, in one mission a site."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held

from executive.arrays import Float
from executive.events.stone import AttemptStarted, StoneGrasped, StoneSeenInJaws
from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_between
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

MISSION = Path(__file__).with_name("held_poses.yaml")
POSITION_M, TURN_DEG = Bound(0.04, 0.02), Bound(4.0, 2.0)


@dataclass(frozen=True, slots=True)
class Look:
    """One look: errors of the pose in the jaws before and after it, in [m] and [°]."""

    is_accepted: bool
    reason: str
    before_m: float
    before_deg: float
    after_m: float
    after_deg: float
    std_m: float

    def __str__(self) -> str:
        told = "seen" if self.is_accepted else f"refused ({self.reason})"
        return (
            f"{told}: {100 * self.before_m:.1f} cm {self.before_deg:.1f}° before, "
            f"{100 * self.after_m:.1f} cm {self.after_deg:.1f}° after"
        )


@dataclass
class Judge:
    """Follows a mission's events, and compares at each look what the simulator knows."""

    looks: list[Look] = field(default_factory=list)
    _judged: int = -1  # number of the last entry that was followed
    _body: str = ""
    _T_body_object: Float = field(default_factory=lambda: np.eye(4))
    _T_world_gripper: Float = field(default_factory=lambda: np.eye(4))

    def __call__(self, mission: Mission) -> None:
        world = mission.services.plugins["robot"].world
        for entry in mission.journal.newest:
            if entry.sequence <= self._judged:
                continue
            self._judged = entry.sequence
            match entry.event:
                case AttemptStarted() as event:
                    self._begin(world, self._stone(mission, event.stone))
                case StoneGrasped():
                    self._T_world_gripper = _pose(world, world.machine.gripper_link)
                case StoneSeenInJaws() as event:
                    self._compare(world, mission, event)

    def _stone(self, mission: Mission, stone: int) -> Any:
        return mission.services.plugins["objects"].stone(stone)

    def _begin(self, world: Any, stone: Any) -> None:
        names = [one.name for one in world.site.stones]
        away = [np.linalg.norm(_pose(world, name)[:3, 3] - stone.centroid_map) for name in names]
        self._body = names[int(np.argmin(away))]
        self._T_body_object = inverse(_pose(world, self._body)) @ stone.T_map_object

    def _compare(self, world: Any, mission: Mission, event: StoneSeenInJaws) -> None:
        history = mission.services.plugins["objects"].history(event.stone)
        grasp = max(i for i, one in enumerate(history) if one.kind == "grasp")
        gripper = _pose(world, world.machine.gripper_link)
        true = inverse(gripper) @ _pose(world, self._body) @ self._T_body_object
        before, after = (
            _error(inverse(self._T_world_gripper) @ one.T_map_object, true)
            for one in (history[grasp], history[-1])
        )
        std_m = np.nan if event.position_std_m is None else event.position_std_m
        self.looks.append(Look(event.accepted, event.reason, *before, *after, std_m))


def looks(seed: int, stones: int, settings: Sequence[str]) -> list[Look]:
    """Return the looks of one site."""
    description = load_mission(str(MISSION), [f"robot.site.stones.count={stones}", *settings])
    judge = Judge()
    with tempfile.TemporaryDirectory() as folder:
        Run(description, Options(run_dir=Path(folder) / "run", seed=seed)).execute(judge)
    return judge.looks


def figures(found: Sequence[Look]) -> list[Figure]:
    """Return errors before and after, with the share of looks that were accepted."""
    if not found:
        return [held("looks", np.nan, Bound(1.0, is_least=True))]
    before_m, before_deg, after_m, after_deg = (
        np.array([getattr(one, name) for one in found])
        for name in ("before_m", "before_deg", "after_m", "after_deg")
    )
    count, seen = len(found), sum(one.is_accepted for one in found)
    off_m, off_deg = np.percentile(after_m, 95), np.percentile(after_deg, 95)
    return [
        Figure("stones whose look was accepted", f"{seen} of {count}"),
        Figure("error before the look, median / p95", _spread(100 * before_m, before_deg)),
        Figure("error after the look, median / p95", _spread(100 * after_m, after_deg)),
        held("pose in the jaws, p95 of all stones [m]", float(off_m), POSITION_M),
        held("pose in the jaws, p95 of all stones [°]", float(off_deg), TURN_DEG),
    ]


def _spread(centimetres: Float, degrees: Float) -> str:
    low, high = np.percentile(centimetres, [50, 95])
    small, large = np.percentile(degrees, [50, 95])
    return f"{low:.1f} / {high:.1f} cm, {small:.1f} / {large:.1f}°"


def _error(estimated: Float, true: Float) -> tuple[float, float]:
    """Return the distance of the centres [m] and the angle between two poses [°]."""
    turn = angle_between(estimated[:3, :3], true[:3, :3])
    return float(np.linalg.norm(estimated[:3, 3] - true[:3, 3])), float(np.degrees(turn))


def _pose(world: Any, body: str) -> Float:
    T = np.eye(4)
    T[:3, :3] = world.data.body(body).xmat.reshape(3, 3)
    T[:3, 3] = world.data.body(body).xpos
    return T
