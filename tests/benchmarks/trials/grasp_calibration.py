"""What networks foretell of lifts in a scenario, beside lifts of the same grasps."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.grasping.classifier.grasp_features import features_of
from executive_plugins.grasping.classifier.outcome_net import load_net, success
from executive_plugins.grasping.classifier.weights_file import weights_file
from executive_plugins.grasping.learning.labels import chosen_for_lifts, network_first
from executive_plugins.grasping.learning.lift_trials import LiftTrials
from executive_plugins.grasping.learning.training import area_under_curve
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.sampling.pool import Sampler
from executive_plugins.grasping.sampling.settings import SamplingSettings
from executive_plugins.grasping.settings import SampledCnnSettings
from executive_plugins.grasping.simulated_lift import LIFTED_M
from executive_plugins.physics.scenario import Scenario

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.machine.machine import load_machine
from trials.grasp_ranking import FreeMotion, interval
from trials.seen_stones import SeenStone, as_surveyed, as_trained

FIRST, OTHERS, LIFTS, BINS = 8, 8, 4, 10
TOO_SURE = Bound(15.0)  # points by which first choices may be predicted better than they are
MACHINE = load_machine("m545")


@dataclass(frozen=True)
class OneStone:
    """Grasps of one stone: (M,) shares of lifts that hold, and by network (M,) predictions.

    Of each network: the rows of its first choices, and score and share of what it plans; None of an
    empty plan.
    """

    share: Float
    likely: Mapping[str, Float]
    first: Mapping[str, list[int]]
    planned: Mapping[str, tuple[float, float] | None]


class Trial:
    """Networks beside each other in one scenario."""

    def __init__(
        self, weights: Sequence[str], world: Scenario, seed: int, soil_m: float | None = None
    ) -> None:
        self._weights, self._world, self._seed = weights, world, seed
        self._sampler = Sampler(SamplingSettings(into_soil_m=soil_m), MACHINE.gripper)
        self._settings = SampledCnnSettings(physics=world, into_soil_m=soil_m)

    @cached_property
    def _planners(self) -> dict[str, SampledCnn]:
        settings = self._settings
        return {
            name: SampledCnn(settings.model_copy(update={"weights": name}), MACHINE, FreeMotion())
            for name in self._weights
        }

    def of_stone(self, i: int, seen: SeenStone) -> OneStone | None:
        """Return what comes of one stone; None if nothing of it can be held."""
        rng = np.random.default_rng((self._seed, i))
        gripper = MACHINE.gripper
        scene = self._sampler.scene(seen.stone.points_map, seen.cloud.points, rng)
        pool = self._sampler.pool(scene, rng)
        if not len(pool):
            return None
        first = {name: network_first(name, scene, pool, gripper, FIRST) for name in self._weights}
        others = chosen_for_lifts(pool, OTHERS, rng)
        rows = np.unique(np.concatenate([*first.values(), others]))
        shown = features_of(scene, pool.taken(rows), gripper)
        likely = {name: success(load_net(weights_file(name)), shown) for name in self._weights}
        share = [
            self._share(i, seen, scene.T_map_plan @ pose(pool.R[k], pool.position[k])) for k in rows
        ]
        return OneStone(
            np.array(share),
            likely,
            {name: [int(np.flatnonzero(rows == k)[0]) for k in of] for name, of in first.items()},
            {name: self._planned(i, seen, planner) for name, planner in self._planners.items()},
        )

    def _planned(self, i: int, seen: SeenStone, planner: SampledCnn) -> tuple[float, float] | None:
        plan = planner.plan(
            seen.stone, seen.cloud, np.eye(4), np.random.default_rng((self._seed, i))
        )
        if not plan.grasps:
            return None
        best = plan.grasps[0]
        return best.score, self._share(i, seen, best.T_map_gripper)

    def _share(self, i: int, seen: SeenStone, T_map_gripper: Float) -> float:
        """Return the share of lifts of a grasp that hold; each grasp has the same draws."""
        s, rng = self._settings, np.random.default_rng((self._seed, i, 2))
        trials = LiftTrials(MACHINE.gripper, seen.hull, self._world, s.arm_error_m, s.arm_error_rad)
        slips = [trials.lift(T_map_gripper, MACHINE.gripper.open_rad, rng) for _ in range(LIFTS)]
        return float(np.mean(np.array(slips) <= LIFTED_M))


def calibration_error(likely: Float, share: Float) -> float:
    """Return the mean distance of prediction and outcome over bins, each by its number."""
    at = np.minimum((likely * BINS).astype(int), BINS - 1)
    gaps = [abs(float((likely - share)[at == k].sum())) for k in range(BINS)]
    return sum(gaps) / len(likely)


def brier(likely: Float, share: Float) -> float:
    """Return the Brier score of predictions, of single lifts whose share is given."""
    return float(np.mean(share * (1 - likely) ** 2 + (1 - share) * likely**2))


def single_area(likely: Float, share: Float) -> float:
    """Return the area under the curve of predictions, against single lifts."""
    held_lifts = np.round(share * LIFTS).astype(int)
    is_held = np.arange(LIFTS) < held_lifts[:, None]
    return area_under_curve(np.repeat(likely, LIFTS), is_held.ravel())


def rows_of(made: Sequence[OneStone], name: str) -> dict[str, Float]:
    """Return figures of a network by stone, each of shape (stones,)."""
    first = [(one.likely[name][one.first[name][0]], one.share[one.first[name]]) for one in made]
    planned = [one.planned[name] or (0.0, 0.0) for one in made]
    return {
        "first choice, predicted": np.array([likely for likely, _ in first]),
        "first choice, held": np.array([share[0] for _, share in first]),
        "best of the first eight, held": np.array([share.max() for _, share in first]),
        "mean of the first eight, held": np.array([share.mean() for _, share in first]),
        "after rehearsal, score": np.array([score for score, _ in planned]),
        "after rehearsal, held": np.array([share for _, share in planned]),
    }


def pooled(made: Sequence[OneStone], name: str) -> dict[str, float]:
    """Return figures of a network over the grasps of all stones."""
    likely = np.concatenate([one.likely[name] for one in made])
    share = np.concatenate([one.share for one in made])
    return {
        "AUC, single lift": single_area(likely, share),
        "Brier score": brier(likely, share),
        "calibration error": calibration_error(likely, share),
    }


def report(made: Sequence[OneStone], weights: Sequence[str]) -> Iterator[Figure]:
    """Print each network, and each one less the first; yield what is held to a bound."""
    grasps = sum(len(one.share) for one in made)
    print(f"{len(made)} stones, {grasps} grasps, {LIFTS} lifts of each")
    base = weights[0]
    draws = np.random.default_rng(0).integers(len(made), size=(400, len(made)))
    for name in weights:
        print(f"\n{name}\n")
        own, other = rows_of(made, name), rows_of(made, base)
        for what, values in own.items():
            less = "" if name == base else f", less {base}: {_points(values - other[what])}"
            print(f"  {what}: {_points(values)} %{less}")
        of_all, of_base = pooled(made, name), pooled(made, base)
        less_base: dict[str, list[float]] = {what: [] for what in of_all}
        for draw in draws if name != base else ():
            again = [made[k] for k in draw]
            for what, value in pooled(again, name).items():
                less_base[what].append(value - pooled(again, base)[what])
        for what, value in of_all.items():
            less = ""
            if name != base:
                low, high = np.percentile(less_base[what], [2.5, 97.5])
                gap = value - of_base[what]
                less = f", less {base}: {gap:+.3f} [{low:+.3f}, {high:+.3f}]"
            print(f"  {what}: {value:.3f}{less}", flush=True)
        empty = sum(one.planned[name] is None for one in made)
        print(f"  stones without a plan: {empty}", flush=True)
        _print_bins(made, name)
    shipped = rows_of(made, weights[-1])
    gap = 100 * (shipped["first choice, predicted"] - shipped["first choice, held"])
    what = f"{weights[-1]}: first choices, predicted above held [points]"
    yield held(what, float(gap.mean()), TOO_SURE, _points(gap / 100))


def _print_bins(made: Sequence[OneStone], name: str) -> None:
    """Print what held where the plan's score was in each fifth."""
    planned = [one.planned[name] for one in made if one.planned[name] is not None]
    score, share = np.array([one[0] for one in planned]), np.array([one[1] for one in planned])
    for low, high in ((0.0, 0.5), (0.5, 0.7), (0.7, 0.8), (0.8, 0.9), (0.9, 1.01)):
        of = (score >= low) & (score < high)
        if of.any():
            told = f"{100 * score[of].mean():.0f} % told, {100 * share[of].mean():.0f} % held"
            print(
                f"  planned with a score of {low:.1f} to {min(high, 1.0):.1f}: {told} ({of.sum()})"
            )


def _points(rates: Float) -> str:
    """Return the mean of rates by stone and its 95 % interval, times 100."""
    low, high = interval(rates)
    return f"{100 * rates.mean():.1f} [{100 * low:.0f}, {100 * high:.0f}]"


def measured(
    weights: Sequence[str],
    world: Scenario,
    stones: int,
    seed: int,
    sites: Sequence[Path],
    soil: float | None = None,
) -> list[Figure]:
    """Compare networks on surveyed sites, or on generated stones if there are none."""
    trial = Trial(weights, world, seed, soil)
    seen = as_surveyed(sites) if sites else as_trained(stones, seed)
    made = [trial.of_stone(i, one) for i, one in enumerate(seen)]
    return list(report([one for one in made if one is not None], weights))
