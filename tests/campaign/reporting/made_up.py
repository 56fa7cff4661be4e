"""Made-up campaigns: results drawn from stated distributions, and figures computed from them."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np

from executive.campaign.description.campaign import Campaign
from executive.campaign.figures.bound import Bound
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.figures import (
    Difference,
    Estimate,
    Figures,
    Interval,
    Judgement,
)
from executive.campaign.trial import Limits, Outcome, Status, Trial

MISSION = "api: 1\nmission: made_up\ntrees:\n  main:\n    wait: 1 s\n"


def campaign(
    seeds: Sequence[int] = range(1, 21), factors: Mapping[str, tuple[str, ...]] | None = None
) -> Campaign:
    """Return a campaign over all combinations of the factors' levels."""
    factors = {"estimation": ("dual_graph", "error_state_ekf")} if factors is None else factors
    cells = [dict(zip(factors, levels, strict=True)) for levels in product(*factors.values())]
    limits = Limits(60.0, 2**30)
    trials = tuple(
        Trial(number, "mission", {"mission": MISSION}, seed, cell, limits)
        for number, (seed, cell) in enumerate(product(seeds, cells))
    )
    first = next(iter(factors), "")
    comparisons = (Comparison(first, factors[first][0], ("success",)),) if first else ()
    return Campaign(
        name="Two estimators",
        description="Whether the dual graph places stones more surely than the filter.",
        trials=trials,
        factors=factors,
        metrics=("success", "placement_error"),
        bounds=(
            Bound("success", "share", 0.9, is_least=True),
            Bound("placement_error", "p95", 0.3, is_least=False),
        ),
        comparisons=comparisons,
        digest="0123456789abcdef",
        command="executive campaign two_estimators.yaml --seeds 1:20",
    )


def outcomes(of: Campaign, share: float = 0.85, seed: int = 0) -> Iterator[Outcome]:
    """Yield outcomes: some missions fail, a few runs have no answer."""
    chance = np.random.default_rng(seed)
    levels = {tuple(trial.levels.values()): None for trial in of.trials}
    rank = {cell: number for number, cell in enumerate(levels)}
    for trial in of.trials:
        worse = 0.4 * rank[tuple(trial.levels.values())] / max(1, len(rank) - 1)
        draw = chance.random()
        kind = {0: Status.CRASHED, 1: Status.TIMED_OUT, 2: Status.KILLED}.get(int(draw * 100))
        if kind:
            reason = {
                Status.CRASHED: "signal 11 (segmentation fault)",
                Status.TIMED_OUT: "longer than 60 s",
                Status.KILLED: "signal 9, from outside of the campaign",
            }[kind]
            yield Outcome(trial.number, kind, reason, {}, 60.0, 30.0, 2**29, 1, "here:1")
            continue
        good = bool(chance.random() < share - worse)
        errors = chance.gamma(2.0, 0.04 + 0.1 * worse, size=int(chance.integers(3, 8)))
        report = {
            "outcome": "success" if good else "failure",
            "reason": "" if good else f"only {int(chance.integers(1, 5))} of 7 stones placed",
        }
        measurements = {
            "success": {"hits": int(good), "of": 1},
            "placement_error": {"values": errors.tolist()},
        }
        answer = {"report": report, "measurements": measurements}
        wall_s = float(chance.gamma(8.0, 4.0))
        peak = int(4e8 + 1e8 * chance.random())
        yield Outcome(trial.number, Status.DONE, "", answer, wall_s, wall_s, peak, 1, "here:2")


def figures(of: Campaign, found: Sequence[Outcome]) -> Figures:
    """Return figures with intervals of a fixed width: their arithmetic is tested elsewhere."""
    by_cell: dict[tuple[tuple[str, str], ...], list[Outcome]] = {}
    for outcome in found:
        by_cell.setdefault(tuple(of.trials[outcome.number].levels.items()), []).append(outcome)
    estimates = [e for cell, some in by_cell.items() for e in _estimates(dict(cell), some)]
    judgements = [
        _judgement(bound, one)
        for bound in of.bounds
        for one in estimates
        if one.metric == bound.metric
    ]
    return Figures(tuple(estimates), tuple(_differences(of, estimates)), tuple(judgements))


def _estimates(levels: Mapping[str, str], found: Sequence[Outcome]) -> list[Estimate]:
    measured = [one.answer["measurements"] for one in found if one.answer]
    hits, without = sum(m["success"]["hits"] for m in measured), len(found) - len(measured)
    values = [v for m in measured for v in m["placement_error"]["values"]]
    share = hits / len(found)
    statistics = {
        name: (q, Interval(0.9 * q, 1.1 * q))
        for name, level in (("median", 0.5), ("p90", 0.9), ("p95", 0.95), ("max", 1.0))
        for q in [float(np.quantile(values, level))]
    }
    within = Interval(max(0.0, share - 0.1), min(1.0, share + 0.08))
    count = len(found)
    return [
        Estimate("success", levels, count, without, count, hits, count, {"share": (share, within)}),
        Estimate(
            "placement_error", levels, count, without, len(measured), 0, len(values), statistics
        ),
    ]


def _judgement(bound: Bound, one: Estimate) -> Judgement:
    value, within = one.statistics[bound.statistic]
    is_met = value >= bound.limit if bound.is_least else value <= bound.limit
    is_sure = not within.low <= bound.limit <= within.high
    return Judgement(bound, one.levels, value, within, is_met, is_sure)


def _differences(of: Campaign, estimates: Sequence[Estimate]) -> Iterator[Difference]:
    for comparison in of.comparisons:
        shares = [one for one in estimates if one.metric == "success"]
        for one in shares:
            level = one.levels[comparison.factor]
            others = {k: v for k, v in one.levels.items() if k != comparison.factor}
            base = next(
                b
                for b in shares
                if b.levels == {**one.levels, comparison.factor: comparison.baseline}
            )
            if level == comparison.baseline:
                continue
            difference = one.statistics["share"][0] - base.statistics["share"][0]
            is_worse = difference < -0.1
            yield Difference(
                metric="success",
                factor=comparison.factor,
                baseline=comparison.baseline,
                level=level,
                others=others,
                pairs=one.runs,
                better=2,
                worse=7,
                difference=difference,
                interval=Interval(difference - 0.09, difference + 0.09),
                verdict="worse" if is_worse else "too_few",
                words=f"{level} is worse." if is_worse else "Too few: 80 seeds would tell.",
            )
