"""Estimators on drawn logs: whether they start, their errors, what their covariance promised."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from bounds import Bound, Figure, held, judged
from drawn_logs.drawn_log import DrawnLog, draw_log
from drawn_logs.estimators import PEER, preload, replayed
from drawn_logs.judge import Verdict, judge
from forked import forked

from executive.estimate.drop import Drop

_START_S = 10.0  # after the motion begins
_SETTLED_S = 30.0  # errors are judged from then on
_STARTS = Bound(0.99, 1.0, is_least=True)
_INSIDE = Bound(0.90, 0.93, is_least=True)
_RATIO = Bound(1.0, 0.8)


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """One estimator on one log; `error` is the text of an exception, empty if there was none."""

    log: str
    starts: bool
    verdict: Verdict | None
    said: str
    error: str
    outage_s: float = 0.0

    @property
    def median_m(self) -> float:
        """Median distance from the truth once settled [m]; inf if there is no such state."""
        if self.verdict is None:
            return float("inf")
        late = self.verdict.stamps_s >= _SETTLED_S
        return float(np.median(self.verdict.error_m[late])) if late.any() else float("inf")

    @property
    def claimed(self) -> float:
        """Share of the time before the outage from the first state that says GLOBAL on, in it."""
        if self.verdict is None:
            return float("nan")
        before = self.verdict.stamps_s < (_SETTLED_S if self.outage_s else np.inf)
        is_global = self.verdict.is_global[before] > 0
        return float(is_global[is_global.argmax() :].mean()) if is_global.any() else float("nan")

    @property
    def outage_m(self) -> float:
        """Distance from the truth at the end of the outage [m]; inf if there is no such state."""
        if self.verdict is None or not self.outage_s:
            return float("inf")
        return self.verdict.near(_SETTLED_S + self.outage_s)


def columns(
    seeds: Sequence[int],
    names: Sequence[str],
    duration_s: float,
    outage_s: float,
    is_told: bool,
    jobs: int = 1,
) -> Mapping[str, list[Outcome]]:
    """Return the outcomes of each estimator, in order of the seeds."""
    found: dict[str, list[Outcome]] = {name: [] for name in names}

    def of(seed: int) -> list[Outcome]:
        log = draw_log(seed, duration_s)
        return [_outcome(name, log, outage_s) for name in names]

    preload(names)
    for outcomes in forked(of, seeds, jobs):
        for name, outcome in zip(names, outcomes, strict=True):
            found[name].append(outcome)
            if is_told:
                print(_line(name, outcome), flush=True)
    return found


def _outcome(name: str, log: DrawnLog, outage_s: float) -> Outcome:
    drops = [Drop("gnss", _SETTLED_S, _SETTLED_S + outage_s)] if outage_s else []
    try:
        replay, said = replayed(name, log, drops)
    except Exception as error:  # an estimator that raises is counted as one that fails
        return Outcome(log.words, False, None, "", f"{type(error).__name__}: {error}"[:120])
    verdict = judge(replay.states, log.motion)
    starts = verdict.started_s <= max(log.motion.moves_from_s, 0.0) + _START_S
    return Outcome(log.words, starts, verdict, said, "", outage_s)


def _line(name: str, outcome: Outcome) -> str:
    verdict = outcome.verdict
    if verdict is None or not np.isfinite(verdict.started_s):
        return f"{outcome.log} | {name}: no state; {outcome.error or outcome.said}"
    return (
        f"{outcome.log} | {name}: from {verdict.started_s:.1f} s, median {outcome.median_m:.3f} m, "
        f"{100 * verdict.inside:.0f} % inside, {100 * outcome.claimed:.0f} % GLOBAL"
        + (f", {outcome.outage_m:.2f} m after the outage" if outcome.outage_s else "")
    )


def _started(outcomes: Sequence[Outcome]) -> float:
    return float(np.mean([outcome.starts for outcome in outcomes]))


def _inside(outcomes: Sequence[Outcome]) -> float:
    """Return the median over the logs with a state of the share inside the 95 % bound."""
    shares = [one.verdict.inside for one in outcomes if one.verdict and len(one.verdict.nees)]
    return float(np.median(shares)) if shares else float("nan")


def _inside_mostly(name: str, outcomes: Sequence[Outcome]) -> Figure:
    """Return how many of the logs with a state are inside for 90 % of the time: all must be."""
    shares = [one.verdict.inside for one in outcomes if one.verdict and len(one.verdict.nees)]
    hits = sum(share >= _INSIDE.must for share in shares)
    words = f"{hits} of {len(shares)}, worst {min(shares, default=0.0):.2f}"
    what = f"{name}: logs that are inside for 90 % of the time"
    return judged(what, words, "all", bool(shares) and hits == len(shares))


def _ratio(mine: Sequence[float], peer: Sequence[float]) -> float:
    """Return the median ratio of errors to the peer's, where the peer has states."""
    ratios = [own / his for own, his in zip(mine, peer, strict=True) if np.isfinite(his)]
    return float(np.median(ratios)) if ratios else float("nan")


def table(found: Mapping[str, list[Outcome]]) -> str:
    """Return all estimators side by side, as Markdown."""
    lines = [
        "| | " + " | ".join(f"`{name}`" for name in found) + " |",
        "|---" * (len(found) + 1) + "|",
    ]
    for title, cell in _rows(found):
        lines.append(f"| {title} | " + " | ".join(cell) + " |")
    return "\n".join(lines)


def _rows(found: Mapping[str, list[Outcome]]) -> Iterator[tuple[str, list[str]]]:
    every = list(found.values())
    yield "logs", [str(len(outcomes)) for outcomes in every]
    yield (
        f"a state within {_START_S:.0f} s of motion [%]",
        [f"{100 * _started(o):.1f}" for o in every],
    )
    yield "exceptions", [str(sum(bool(one.error) for one in o)) for o in every]
    medians = [[one.median_m for one in o if np.isfinite(one.median_m)] for o in every]
    yield (
        "median error of a log [m]: median, worst",
        [f"{np.median(m):.3f}, {max(m):.3g}" if m else "-" for m in medians],
    )
    yield "inside the 95 % bound [% of the time]", [f"{100 * _inside(o):.0f}" for o in every]
    claims = [[one.claimed for one in o if np.isfinite(one.claimed)] for o in every]
    yield (
        "GLOBAL once it was, before the outage [% of the time]: mean, least",
        [f"{100 * np.mean(c):.1f}, {100 * min(c):.0f}" if c else "-" for c in claims],
    )


def figures(found: Mapping[str, list[Outcome]], name: str) -> list[Figure]:
    """Return the figures of one estimator with their bounds."""
    mine = found[name]
    n = len(mine)
    answer = [
        held(
            f"{name}: logs with a state within {_START_S:.0f} s of motion",
            _started(mine),
            _STARTS,
            f"{_started(mine):.3f} (n = {n})",
        ),
        held(f"{name}: share of time inside the 95 % bound", _inside(mine), _INSIDE),
        _inside_mostly(name, mine),
    ]
    if PEER in found and name != PEER:
        pairs = {"error": [[one.median_m for one in o] for o in (mine, found[PEER])]}
        if mine and mine[0].outage_s:
            ends = [[one.outage_m for one in o] for o in (mine, found[PEER])]
            pairs[f"error after an outage of {mine[0].outage_s:.0f} s"] = ends
        for what, (own, peer) in pairs.items():
            ratio = _ratio(own, peer)
            answer.append(held(f"{name}: {what} over that of {PEER}, median", ratio, _RATIO))
    return answer
