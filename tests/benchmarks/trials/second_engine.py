"""The same grasps lifted in two engines: how often they agree, and whether rankings survive."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, islice
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.grasping.learning.labels import LabelSettings
from executive_plugins.grasping.learning.lift_trials import LiftErrors, LiftTrials
from executive_plugins.grasping.learning.training_scene import Solid, look_at
from executive_plugins.grasping.sampled_antipodal import SampledAntipodal
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.settings import SampledAntipodalSettings, SampledCnnSettings
from executive_plugins.grasping.simulated_lift import LIFTED_M, OPENED_RAD, SimulatedLift
from executive_plugins.physics.scenario import Scenario

from executive.arrays import Float
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState
from trials.bullet_lift import BulletLift
from trials.grasp_ranking import ABOVE_THE_PAPER, FreeMotion, interval
from trials.lone_stones import generated, scanned

MACHINE = load_machine("m545")
UP = np.array([0.0, 0.0, 1.0])
LIFTS, PAPERS = 4, 3  # of each grasp; grasps in the paper's order, beside the network's first
APART = 0.5  # share of lifts by which two grasps are told apart
# By chance half of the pairs have the same order; the stretch leaves one in ten to what is the
# engine's own.
SAME_ORDER = Bound(0.8, 0.9, is_least=True)


@dataclass(frozen=True, slots=True)
class Shares:
    """Shares of the lifts of each grasp of one stone that held.

    Attributes:
        mujoco: In MuJoCo; the first is the network's pick, the others are in the paper's order.
        bullet: In Bullet.
        alike: Number of lifts of the stone in which both engines hold it, or neither does.
    """

    mujoco: Float
    bullet: Float
    alike: int


def measure(
    kind: str, stones: Iterator[tuple[Float, Solid]], seed: int, scenario: Scenario
) -> list[Figure]:
    """Lift grasps of all stones in both engines, and compare."""
    network = SampledCnn(SampledCnnSettings(), MACHINE, FreeMotion())
    paper = SampledAntipodal(SampledAntipodalSettings(rehearsed=0), MACHINE, FreeMotion())
    found, unplanned = [], 0
    for i, (hull, solid) in enumerate(stones):
        view = look_at(solid, (), np.random.default_rng((seed, i, 1)))
        seen = Stone(1, StoneState.ON_GROUND, view.stone, view.stone.mean(axis=0), np.eye(4), True)
        learned, ordered = (
            planner.plan(seen, Cloud("map", view.cloud), np.eye(4), np.random.default_rng(i)).grasps
            for planner in (network, paper)
        )
        if not learned or not ordered:
            unplanned += 1
            continue
        poses = [grasp.T_map_gripper for grasp in (learned[0], *ordered[:PAPERS])]
        found.append(_lifted(hull, poses, (seed, i, 2), scenario))
    print(f"{kind}: {len(found)} stones, and {unplanned} on which a planner found no grasp")
    return _figures(f"{kind} in {scenario}", found)


def _lifted(hull: Float, poses: list[Float], seed: tuple[int, ...], scenario: Scenario) -> Shares:
    trials = LiftTrials(MACHINE.gripper, hull, scenario)
    holds = np.zeros((len(poses), LIFTS, 2), dtype=bool)
    for which, T_map_gripper in enumerate(poses):
        rng = np.random.default_rng(seed)
        for lift in range(LIFTS):
            slips = _slips_m(hull, T_map_gripper, trials.draw(rng))
            holds[which, lift] = np.array(slips) <= LIFTED_M
    mujoco, bullet = holds.mean(axis=1).T
    return Shares(mujoco, bullet, int((holds[..., 0] == holds[..., 1]).sum()))


def _slips_m(hull: Float, T_map_gripper: Float, drawn: LiftErrors) -> tuple[float, float]:
    """Return the slip of one lift in MuJoCo and in Bullet [m]."""
    gripper = MACHINE.gripper
    T, jaw_rad = T_map_gripper @ drawn.T_gripper_arrived, gripper.open_rad + OPENED_RAD
    first = SimulatedLift(gripper, hull, UP, drawn.mass_kg).lift(T, jaw_rad, drawn.contact)
    return first.slip_m, BulletLift(gripper, hull, drawn.mass_kg).slip_m(T, jaw_rad, drawn.contact)


def _figures(what: str, found: list[Shares]) -> list[Figure]:
    lifts = sum(LIFTS * len(one.mujoco) for one in found)
    alike = sum(one.alike for one in found)
    share = f"{100 * alike / lifts:.1f} % of {lifts}" if lifts else "no lift"
    orders = [order for one in found for order in _orders(one)]
    same = float(np.mean(orders)) if orders else float("nan")
    figures = [
        Figure(f"{what}: lifts with the same end in both engines", share),
        held(f"{what}: pairs in the same order", same, SAME_ORDER, f"{same:.3f} of {len(orders)}"),
    ]
    for engine in ("mujoco", "bullet"):
        shares = [getattr(one, engine) for one in found]
        more = 100 * np.array([one[0] - one[1] for one in shares])
        low, high = interval(more)
        words = f"{more.mean():.1f} [{low:.0f}, {high:.0f}] of {len(more)} stones"
        text = f"{what}: network above the paper's order in {engine} [points]"
        figures.append(held(text, float(more.mean()), ABOVE_THE_PAPER, words))
    return figures


def _orders(one: Shares) -> Iterator[float]:
    """Yield 1 for a pair of grasps that both engines order alike, 0.5 for a tie in Bullet, 0 else;
    pairs that MuJoCo does not tell apart are left out.
    """
    for a, b in combinations(range(len(one.mujoco)), 2):
        first = one.mujoco[a] - one.mujoco[b]
        if abs(first) >= APART:
            yield 0.5 + 0.5 * float(np.sign(first) * np.sign(one.bullet[a] - one.bullet[b]))


def measured(stones: int, seed: int, scans: Path | None, scenario: Scenario) -> list[Figure]:
    """Compare the engines on generated stones, and on the scans of a folder if one is given."""
    drawn = islice(generated(LabelSettings(), seed), stones)
    found = measure("generated", drawn, seed, scenario)
    if scans is not None:
        found += measure("scanned", islice(scanned(scans, seed), stones), seed, scenario)
    return found
