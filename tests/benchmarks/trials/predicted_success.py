"""What missions expected of first attempts, and what came of them by the truth."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from bounds import Bound, Figure, held

from executive.mission.report import NEAR_M
from trials.ended import Ended

MOST = Bound(0.05, 0.03)
_BINS = (0.6, 0.8, 0.9)


@dataclass(frozen=True, slots=True)
class Attempt:
    """A first attempt: its world, what was expected of it, its grasp's score, and what came."""

    world: str
    expected: float | None
    score: float
    has_placed: bool


def attempts_of(run: Ended) -> Iterator[Attempt]:
    """Yield the first attempt at each stone of a run whose truth is known."""
    near = {
        stone["held_object"]
        for stone in run.truth.get("stones") or ()
        if (stone.get("slot_error_m") or 0.0) <= NEAR_M
    }
    known: set[int] = set()
    for pick in run.report.get("picks") or ():
        stone, tries = pick["object"], pick["attempts"]
        if stone in known or not tries:
            continue
        known.add(stone)
        placed = bool(pick["placed"]) and len(tries) == 1 and stone in near
        first = tries[0]
        yield Attempt(run.truth["scenario"], first.get("success"), first["grasp"]["score"], placed)


def calibration_error(expected: Sequence[float], placed: Sequence[bool]) -> float:
    """Return the calibration error of chances over four bins, 0 to 1; NaN of none."""
    if not expected:
        return float("nan")
    chances, came = np.asarray(expected), np.asarray(placed, dtype=float)
    which = np.digitize(chances, _BINS)
    gaps = np.bincount(which, came - chances, minlength=len(_BINS) + 1)
    return float(np.abs(gaps).sum() / len(chances))


def figures(runs: Sequence[Ended], least_attempts: int) -> list[Figure]:
    """Return the calibration of each world and of all together."""
    blind = [run.folder.name for run in runs if not run.truth]
    found = [attempt for run in runs if run.truth for attempt in attempts_of(run)]
    untold = sum(one.expected is None for one in found)
    by_world: dict[str, list[Attempt]] = defaultdict(list)
    for one in found:
        by_world[one.world].append(one)
    never = Bound(0)
    return [
        held("runs without truth", len(blind), never, " ".join(map(str, [len(blind), *blind]))),
        held("first attempts of which nothing was expected", untold, never),
        *(
            figure
            for world in sorted(by_world)
            for figure in _calibration(world, by_world[world], least_attempts)
        ),
        *_calibration("all worlds", found, least_attempts),
    ]


def _calibration(world: str, attempts: Sequence[Attempt], least: int) -> Iterator[Figure]:
    told = [(one.expected, one.has_placed) for one in attempts if one.expected is not None]
    expected, placed = [chance for chance, _ in told], [came for _, came in told]
    error = calibration_error(expected, placed)
    words = "nothing was expected of any"
    if told:
        mean, share = np.mean(expected), np.mean(placed)
        words = f"{error:.1%}, {mean:.1%} expected and {share:.1%} placed of {len(told)}"
    yield held(f"{world}: first attempts", len(attempts), Bound(least, is_least=True))
    yield held(f"{world}: calibration error of the expected success", error, MOST, words)
    yield Figure(f"{world}: placed, by what was expected", _by_bin(told))
    of_score = calibration_error(
        [one.score for one in attempts], [one.has_placed for one in attempts]
    )
    yield Figure(f"{world}: the same error of the score alone", f"{of_score:.1%}")


def _by_bin(told: Sequence[tuple[float, bool]]) -> str:
    """Return how many were placed of those in each bin."""
    limits = [0.0, *_BINS, 1.01]
    parts = []
    for low, high in pairwise(limits):
        inside = [(chance, came) for chance, came in told if low <= chance < high]
        if inside:
            mean = np.mean([chance for chance, _ in inside])
            parts.append(f"{mean:.0%}: {sum(came for _, came in inside)} of {len(inside)}")
    return ", ".join(parts)
