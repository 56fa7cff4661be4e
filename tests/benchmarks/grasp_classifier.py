"""How well the shipped networks tell grasps that lift from others, how well anything could, and
what they pick.

    python tests/benchmarks/grasp_classifier.py --stones 60 --scans DIR

Each grasp is lifted eight times, each time with noise of its own on pose, friction and density. A
single lift is partly chance: the `ceiling` is the area under the curve of a judge who knows the
other seven lifts. `usual` asks whether most of the eight succeed, which is what a planner wants to
know. Picked from the same grasps of a stone, half of them the paper's first: the paper's first, and
the one of the highest predicted success. Stones are unseen in training; DIR holds scans [dm].
Intervals of 95 % by bootstrap over stones.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from executive_plugins.grasping.classifier.grasp_features import features_of
from executive_plugins.grasping.classifier.outcome_net import load_net, success
from executive_plugins.grasping.learning.labels import LabelSettings, chosen_for_lifts
from executive_plugins.grasping.learning.lift_trials import LIFTED_M, LiftTrials
from executive_plugins.grasping.learning.training import area_under_curve
from executive_plugins.grasping.learning.training_scene import Solid, look_at
from executive_plugins.grasping.sampled_cnn import weights_file
from executive_plugins.grasping.sampling.pool import Sampler, SamplingSettings
from lone_stones import generated, scanned
from numpy.typing import NDArray

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.machine.machine import load_machine

SEED, GRASPS, LIFTS = 78, 16, 8


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


def report(kind: str, made: list[Judged]) -> None:
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


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Area under the curve of grasp classifiers against simulated lifts."
    )
    parser.add_argument("--stones", type=int, default=60)
    parser.add_argument("--scans", type=Path)
    parser.add_argument("--weights", nargs="*", default=["two_stream", "four_layer"])
    options = parser.parse_args()
    kinds = {"blocks": LabelSettings(rounded=0.0), "rounded": LabelSettings(rounded=1.0)}
    for kind, settings in kinds.items():
        report(
            kind, list(judged(islice(generated(settings, SEED), options.stones), options.weights))
        )
    if options.scans:
        report(
            "scanned",
            list(judged(islice(scanned(options.scans, SEED), options.stones), options.weights)),
        )


if __name__ == "__main__":
    main()
