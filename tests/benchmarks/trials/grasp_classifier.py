"""Predictions of the shipped networks beside repeated simulated lifts.

Each grasp is lifted eight times, each time with noise of its own on pose, friction and density.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.grasping.classifier.grasp_features import features_of
from executive_plugins.grasping.classifier.outcome_net import load_net, success
from executive_plugins.grasping.classifier.weights_file import weights_file
from executive_plugins.grasping.learning.labels import LabelSettings, chosen_for_lifts
from executive_plugins.grasping.learning.lift_trials import LiftTrials
from executive_plugins.grasping.learning.training import area_under_curve
from executive_plugins.grasping.learning.training_scene import Solid, look_at
from executive_plugins.grasping.sampling.pool import Sampler
from executive_plugins.grasping.sampling.settings import SamplingSettings
from executive_plugins.grasping.simulated_lift import LIFTED_M
from numpy.typing import NDArray

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.machine.machine import load_machine
from trials.lone_stones import generated, scanned

SEED, GRASPS, LIFTS = 78, 16, 8
HELD = "two_stream_kind"  # it has learned from lifts in `kind`, as these are
AREA = {
    "blocks": Bound(0.90, 0.95, is_least=True),
    "rounded": Bound(0.90, 0.95, is_least=True),
    "scanned": Bound(0.85, 0.92, is_least=True),
}
ABOVE_THE_PAPER = Bound(10, 15, is_least=True)  # points, of the same grasps
KINDS = {"blocks": LabelSettings(rounded=0.0), "rounded": LabelSettings(rounded=1.0)}


@dataclass(frozen=True)
class Judged:
    """Grasps of one stone: predictions by network, shape (M,), and outcomes, shape (M, 8)."""

    likely: dict[str, Float]
    is_lifted: NDArray[np.bool_]


def judged(stones: Iterator[tuple[Float, Solid]], weights: list[str]) -> Iterator[Judged]:
    gripper = load_machine("m545").gripper
    sampler, nets = (
        Sampler(SamplingSettings(), gripper),
        {name: load_net(weights_file(name)) for name in weights},
    )
    for i, (hull, solid) in enumerate(stones):
        rng = np.random.default_rng((SEED, i))
        view, trials = look_at(solid, (), rng), LiftTrials(gripper, hull)
        scene = sampler.scene(view.stone, view.cloud, rng)
        pool = sampler.pool(scene, rng)
        pool = pool.taken(chosen_for_lifts(pool, GRASPS, rng))
        if not len(pool):
            continue
        slip_m = [
            [trials.lift(scene.T_map_plan @ pose(R, at), jaw_rad, rng) for _ in range(LIFTS)]
            for R, at, jaw_rad in zip(pool.R, pool.position, pool.jaw_rad, strict=True)
        ]
        shown = features_of(scene, pool, gripper)
        yield Judged(
            {name: success(net, shown) for name, net in nets.items()}, np.array(slip_m) <= LIFTED_M
        )


def areas(score: Float, is_lifted: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the AUC against single lifts, the mean over the eight, and against what usually
    happens.
    """
    single = np.mean([area_under_curve(score, is_lifted[:, k]) for k in range(LIFTS)])
    return float(single), area_under_curve(score, is_lifted.mean(axis=1) > 0.5)


def ceiling(is_lifted: NDArray[np.bool_]) -> float:
    """Return the AUC against each lift of the mean of the seven others."""
    others = (is_lifted.sum(axis=1, keepdims=True) - is_lifted) / (LIFTS - 1)
    return float(np.mean([area_under_curve(others[:, k], is_lifted[:, k]) for k in range(LIFTS)]))


def report(kind: str, made: list[Judged]) -> Iterator[Figure]:
    """Print the table of a kind of stones, and yield what is held to a bound."""
    is_lifted = np.concatenate([stone.is_lifted for stone in made])
    first = np.array([stone.is_lifted[0].mean() for stone in made])
    print(
        f"\n{kind}: {len(made)} stones, {is_lifted.size} lifts, "
        f"{100 * is_lifted.mean():.0f} % succeed\n"
    )
    print("| judge | AUC, single lift | AUC, usual | picks that lift | over the paper's |")
    print("|---|---|---|---|---|")
    print(f"| ceiling | {ceiling(is_lifted):.3f} | | | |")
    print(f"| paper | | | {_percent(first)} | |")
    for name in made[0].likely:
        picked = np.array([stone.is_lifted[stone.likely[name].argmax()].mean() for stone in made])
        single, usual = areas(np.concatenate([stone.likely[name] for stone in made]), is_lifted)
        low, high = np.percentile(_resampled(made, name), [2.5, 97.5])
        figures = f"{single:.3f} [{low:.3f}, {high:.3f}] | {usual:.3f}"
        print(
            f"| {name} | {figures} | {_percent(picked)} | {_percent(picked - first)} |", flush=True
        )
        if name == HELD or len(made[0].likely) == 1:
            yield held(f"{name} on {kind}: AUC, single lift", single, AREA[kind], f"{single:.3f}")
            points = 100 * float(np.mean(picked - first))
            yield held(
                f"{name} on {kind}: picks above the paper's [points]",
                points,
                ABOVE_THE_PAPER,
                _percent(picked - first),
            )


def _percent(rates: Float) -> str:
    """Return the mean and its 95 % interval [%]."""
    draws = np.random.default_rng(0).integers(len(rates), size=(4000, len(rates)))
    low, high = np.percentile(rates[draws].mean(axis=1), [2.5, 97.5])
    return f"{100 * rates.mean():.1f} [{100 * low:.0f}, {100 * high:.0f}]"


def _resampled(made: list[Judged], name: str, draws: int = 300) -> list[float]:
    """Return the AUC against single lifts over bootstrap draws of stones."""
    rng, results = np.random.default_rng(0), []
    for _ in range(draws):
        drawn = [made[i] for i in rng.integers(len(made), size=len(made))]
        score = np.concatenate([stone.likely[name] for stone in drawn])
        results.append(areas(score, np.concatenate([stone.is_lifted for stone in drawn]))[0])
    return results


def measured(stones: int, scans: Path | None, weights: list[str]) -> list[Figure]:
    """Judge each kind of stones, the scans of a folder where one is given."""
    found = []
    for kind, settings in KINDS.items():
        found += report(kind, list(judged(islice(generated(settings, SEED), stones), weights)))
    if scans is not None:
        found += report("scanned", list(judged(islice(scanned(scans, SEED), stones), weights)))
    return found
