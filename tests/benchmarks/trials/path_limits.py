"""Planned motions on drawn sites: shares of the joints' limits, times beside toppra's, costs."""

import importlib.util
import runpy
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.motion.hermite import Hermite
from scipy.interpolate import CubicSpline

from executive.arrays import Float
from executive.machine.machine import Machine, load_machine
from executive.messages.request import MotionPlan, MoveRequest, PostureRequest
from executive.messages.trajectory import JointTrajectory

_SHARED = runpy.run_path(str(Path(__file__).parents[2] / "plugins" / "motion" / "conftest.py"))
_RINGS = {"m545": ((4.0, 7.0), 1.0), "mini": ((2.8, 4.7), 0.6)}  # of the stones [m], and their size
STEP_S = 0.001
_PATH_STEP = 0.02  # between the points through which toppra's path goes, in shares of the speed
WITHIN = Bound(1.0)
TIME, COST_MS = Bound(1.15, 1.05), Bound(80.0, 50.0)
_ORDERS = ("velocity", "acceleration", "jerk")
Request = MoveRequest | PostureRequest


@dataclass(frozen=True, slots=True)
class Planned:
    """What came of one request.

    Attributes:
        is_loaded: Whether a stone is held.
        cost_s: Processor time of planning [s].
        reason: Why there is no motion; empty if there is one.
        shares: Largest velocity, acceleration and jerk of each joint in shares of its limit,
            shape (3, n).
        duration_s: Duration of the motion [s].
        fastest_s: Duration that toppra finds for its path [s]; NaN where it was not asked.
    """

    is_loaded: bool
    cost_s: float
    reason: str
    shares: Float
    duration_s: float
    fastest_s: float


def measured(model: str, seeds: Sequence[int], most: int) -> list[Planned]:
    """Plan on the sites of the seeds until there are so many motions."""
    machine, planner = load_machine(model), _SHARED["started"](model)
    found: list[Planned] = []
    for seed in seeds:
        for request, plan, cost_s in _planned(machine, planner, seed):
            found.append(_judged(planner, machine, request, plan, cost_s))
            if sum(not one.reason for one in found) >= most:
                return found
    return found


def _planned(
    machine: Machine, planner: Hermite, seed: int
) -> Iterator[tuple[Request, MotionPlan, float]]:
    site = _SHARED["Site"](machine, *_RINGS[machine.name], seed)
    start = machine.posture("scan")
    for stone in range(5):
        pick = site.pick(start, stone)
        there, cost_s = _timed(planner, pick)
        yield pick, there, cost_s
        if there.trajectory is None:
            continue
        place = site.place(there.trajectory.position[-1], pick.T_map_gripper, stone)
        back, cost_s = _timed(planner, place)
        yield place, back, cost_s
        if back.trajectory is None:
            continue
        start = back.trajectory.position[-1]
        goal = _drawn_posture(machine, site.rng)
        asked = PostureRequest(
            start, goal, pick.T_map_base, pick.obstacles, None, machine.gripper.open_rad
        )
        away, cost_s = _timed(planner, asked)
        yield asked, away, cost_s
        if away.trajectory is not None:
            start = away.trajectory.position[-1]


def _drawn_posture(machine: Machine, rng: np.random.Generator) -> Float:
    """Draw a posture about the carrying one, with any heading."""
    q = machine.posture("carry") + rng.normal(0.0, 0.15, len(machine.joints))
    q[machine.arm_names.index(machine.turn_joint)] += rng.uniform(-np.pi, np.pi)
    return np.asarray(np.clip(q, machine.lower + 0.01, machine.upper - 0.01))


def _timed(planner: Hermite, request: Request) -> tuple[MotionPlan, float]:
    began_s = time.process_time()
    if isinstance(request, MoveRequest):
        plan = planner.move(request)
    else:
        plan = planner.move_joints(request)
    return plan, time.process_time() - began_s


def _judged(
    planner: Hermite, machine: Machine, request: Request, plan: MotionPlan, cost_s: float
) -> Planned:
    is_loaded = request.held_gripper is not None
    if plan.trajectory is None:
        nothing = np.full((3, len(machine.joints)), np.nan)
        return Planned(is_loaded, cost_s, plan.reason, nothing, np.nan, np.nan)
    limits = _limits(machine, is_loaded)
    shares = _shares(plan.trajectory, limits)
    fastest_s = np.nan
    if importlib.util.find_spec("toppra") is not None:
        kept = planner.limits(request)
        fastest_s = _fastest_s(plan.trajectory, kept.velocity, kept.acceleration)
    return Planned(is_loaded, cost_s, "", shares, plan.trajectory.duration_s, fastest_s)


def _limits(machine: Machine, is_loaded: bool) -> tuple[Float, Float, Float]:
    if is_loaded:
        return machine.loaded_max_velocity, machine.loaded_max_acceleration, machine.max_jerk
    return machine.max_velocity, machine.max_acceleration, machine.max_jerk


def _shares(trajectory: JointTrajectory, limits: tuple[Float, Float, Float]) -> Float:
    times = np.arange(0.0, trajectory.duration_s + 3 * STEP_S, STEP_S)
    q = np.array([trajectory.at(float(t))[0] for t in times])
    # Rounding of positions, some four units in their last place, is no motion: of a third
    # difference it makes up to 2e-5 of the limit.
    rounding = 4 * np.finfo(np.float64).eps * np.abs(q).max()
    return np.array(
        [
            (np.abs(np.diff(q, order, axis=0)).max(axis=0) - 2**order * rounding)
            / (STEP_S**order * limit)
            for order, limit in enumerate(limits, start=1)
        ]
    )


def _fastest_s(trajectory: JointTrajectory, velocity: Float, acceleration: Float) -> float:
    """Return toppra's time for the path of a trajectory, through points that are evenly apart."""
    import toppra
    from toppra import algorithm, constraint

    toppra.setup_logging("ERROR")
    q = trajectory.position
    passed = np.concatenate([[0.0], np.cumsum((np.abs(np.diff(q, axis=0)) / velocity).max(axis=1))])
    moves = np.concatenate([[True], np.diff(passed) > 1e-9])
    at = np.linspace(0.0, passed[-1], max(8, int(np.ceil(passed[-1] / _PATH_STEP))))
    points = CubicSpline(passed[moves], q[moves])(at)
    path = toppra.SplineInterpolator(at, points)
    limits = [
        constraint.JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    timed: Any = algorithm.TOPPRA(limits, path, gridpoints=at).compute_trajectory(0, 0)
    return np.nan if timed is None else float(timed.duration)


def figures(found: Sequence[Planned]) -> list[Figure]:
    """Return the figures of the motions, the empty and the loaded ones apart."""
    moved = [one for one in found if not one.reason]
    reasons = Counter(one.reason.partition(":")[0] for one in found if one.reason)
    durations = np.array([one.duration_s for one in moved])
    return [
        *_shares_of("empty", [one for one in moved if not one.is_loaded]),
        *_shares_of("loaded", [one for one in moved if one.is_loaded]),
        _times(moved),
        _costs(found),
        Figure("duration, p50 [s]", f"{np.median(durations):.2f}" if moved else "none"),
        Figure("refused", ", ".join(f"{n} {r}" for r, n in reasons.items()) or "none"),
    ]


def _shares_of(words: str, some: Sequence[Planned]) -> list[Figure]:
    whats = [f"{order}, share of its limit, {len(some)} paths, {words}" for order in _ORDERS]
    if not some:
        return [held(what, float("nan"), WITHIN) for what in whats]
    most = np.max([one.shares for one in some], axis=(0, 2))
    return [
        held(what, float(share), WITHIN, f"{share:.4f}")
        for what, share in zip(whats, most, strict=True)
    ]


def _times(moved: Sequence[Planned]) -> Figure:
    what = "time in that of toppra without jerk, p50"
    ratios = np.array([one.duration_s / one.fastest_s for one in moved])
    ratios = ratios[np.isfinite(ratios)]
    if not len(ratios):
        return Figure(what, "not compared: toppra is not installed")
    p50, p95 = np.percentile(ratios, [50, 95])
    return held(what, float(p50), TIME, f"{p50:.3f} (p95 {p95:.3f}, {len(ratios)} paths)")


def _costs(found: Sequence[Planned]) -> Figure:
    p50, p95 = np.percentile([1e3 * one.cost_s for one in found], [50, 95])
    words = f"{p95:.0f} (p50 {p50:.0f}, {len(found)} requests)"
    return held("processor time of planning, p95 [ms]", float(p95), COST_MS, words)
