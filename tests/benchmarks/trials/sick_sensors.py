"""An estimator on drawn logs of which one sensor falls sick."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from bounds import Bound, Figure, held
from drawn_logs.drawn_log import DrawnLog, draw_log
from drawn_logs.estimators import Run
from drawn_logs.judge import Verdict, judge
from drawn_logs.sickness import SICKNESSES, Sickness
from forked import forked
from scipy.stats import chi2

from executive.arrays import Bool
from executive.messages.odometry import LidarIncrement

_FROM_S, _AFTER_S = 25.0, 12.0  # begin of the fault; what is seen after its end
_BEYOND = float(chi2.ppf(0.9973, 3))  # three standard deviations
_LONGEST_S, _RECOVERED_S = 3.0, 2.0
_NONE = Bound(0.0)
_RECOVERS = Bound(_RECOVERED_S, 1.0)
_EXACT = Bound(1.0)


@dataclass(frozen=True, slots=True)
class Trial:
    """What came of one fault on one log.

    Attributes:
        name: Of the fault.
        log: What was drawn.
        wrong_s: Longest time with the status GLOBAL in one stay beyond three standard deviations,
            from the fault on [s].
        recovered_s: From the end of the fault until the position is within them for good [s].
        largest_m: Largest error from the fault on [m].
        allowed_m: Three standard deviations of a fixed RTK fix and 2 cm; inf for other fixes.
        error: Text of an exception; empty if there was none.
    """

    name: str
    log: str
    wrong_s: float
    recovered_s: float
    largest_m: float
    allowed_m: float
    error: str = ""


def kinds(text: str) -> Mapping[str, Sickness]:
    """Return the faults whose name begins with a text."""
    return {name: one for name, one in SICKNESSES.items() if name.startswith(text)}


def run(
    chosen: Mapping[str, Sickness],
    seeds: Sequence[int],
    estimator: str,
    is_told: bool,
    jobs: int = 1,
) -> list[Trial]:
    """Return the outcome of every fault on every seed's log.

    The faults of a log share its sound beginning: it is replayed once.
    """
    trials = []
    for seed in seeds:
        for trial in _trials(chosen, seed, estimator, jobs):
            trials.append(trial)
            if is_told:
                print(_line(trial), flush=True)
    return trials


def _trials(
    chosen: Mapping[str, Sickness], seed: int, estimator: str, jobs: int
) -> Iterator[Trial]:
    longest_s = max(sickness.lasts_s for sickness in chosen.values())
    log = draw_log(seed, _FROM_S + longest_s + _AFTER_S, is_sound=True)
    count = sum(arrival.arrival_s < _FROM_S for arrival in log.arrivals)
    begun = Run(estimator, log)
    try:
        begun.feed(log.arrivals[:count])
        rest = replace(log, arrivals=log.arrivals[count:])
        yield from forked(lambda one: _trial(*one, rest, begun), chosen.items(), jobs)
    finally:
        begun.close()


def _trial(name: str, sickness: Sickness, log: DrawnLog, begun: Run) -> Trial:
    gnss, rng = log.gnss, np.random.default_rng(log.seed)
    sick = sickness.of(log.arrivals, log.datum, _FROM_S, rng)
    until_s = _FROM_S + sickness.lasts_s + _AFTER_S
    allowed_m = float("inf")
    if gnss.is_rtk_fixed and sickness.kind is LidarIncrement:
        allowed_m = 3 * float(np.hypot(np.sqrt(2) * gnss.horizontal_m, gnss.vertical_m)) + 0.02
    try:
        replay = begun.feed([arrival for arrival in sick if arrival.arrival_s <= until_s])
    except Exception as error:  # an estimator that raises is counted as one that fails
        inf = float("inf")
        said = f"{type(error).__name__}: {error}"[:120]
        return Trial(name, log.words, inf, inf, inf, allowed_m, said)
    judged = judge(replay.states, log.motion)
    return Trial(
        name,
        log.words,
        _longest(judged),
        _recovered(judged, _FROM_S + sickness.lasts_s),
        float(judged.error_m[judged.stamps_s >= _FROM_S].max(initial=0.0)),
        allowed_m,
    )


def _is_beyond(judged: Verdict) -> Bool:
    return np.asarray(judged.position_nees > _BEYOND)


def _longest(judged: Verdict) -> float:
    """Return the longest time of wrong claims until the state is right, from the fault on [s]."""
    beyond = _is_beyond(judged) & (judged.stamps_s >= _FROM_S)
    steps_s = np.diff(judged.stamps_s, append=judged.stamps_s[-1:])
    longest_s = claimed_s = 0.0
    for step_s, is_beyond, is_claimed in zip(steps_s, beyond, judged.is_global > 0, strict=True):
        claimed_s = claimed_s + step_s * is_claimed if is_beyond else 0.0
        longest_s = max(longest_s, claimed_s)
    return float(longest_s)


def _recovered(judged: Verdict, end_s: float) -> float:
    """Return how long after the fault's end the position is outside [s]; inf if to the end."""
    late = judged.stamps_s >= end_s
    if not late.any():
        return float("inf")
    # Few sound states are outside by chance: two in a row count.
    beyond = _is_beyond(judged)[late]
    twice = np.flatnonzero(beyond[1:] & beyond[:-1]) + 1
    if not len(twice):
        return 0.0
    stamps_s = judged.stamps_s[late]
    is_at_end = twice[-1] >= len(stamps_s) - 2
    return float("inf") if is_at_end else float(stamps_s[twice[-1]] - end_s)


def _line(trial: Trial) -> str:
    return (
        f"{trial.name} | {trial.log} | {trial.error or f'beyond for {trial.wrong_s:.1f} s'}, "
        f"recovered after {trial.recovered_s:.1f} s, at most {trial.largest_m:.2f} m off"
    )


def figures(trials: Sequence[Trial]) -> list[Figure]:
    """Return the figures with their bounds, and which kinds miss."""
    wrong = [one for one in trials if not one.wrong_s <= _LONGEST_S]
    late = np.array([one.recovered_s for one in trials])
    answer = [
        held(
            "trials that say GLOBAL beyond three standard deviations for longer than 3 s",
            float(len(wrong)),
            _NONE,
            f"{len(wrong)} of {len(trials)}",
        ),
        held(
            "recovery after the fault, 95 % of the trials [s]",
            float(np.percentile(late, 95, method="higher")),
            _RECOVERS,
        ),
        Figure("trials that recover within 2 s", f"{(late <= _RECOVERED_S).sum()} of {len(late)}"),
    ]
    exact = [one.largest_m / one.allowed_m for one in trials if np.isfinite(one.allowed_m)]
    if exact:
        words = f"{max(exact):.2f} (n = {len(exact)})"
        what = "RTK with sick odometry: error over three of its deviations and 2 cm, largest"
        answer.append(held(what, max(exact), _EXACT, words))
    answer += _worst(wrong)
    return answer


def _worst(wrong: Sequence[Trial]) -> Iterator[Figure]:
    """Yield a line for each kind of fault that was missed."""
    for name in dict.fromkeys(one.name for one in wrong):
        mine = [one for one in wrong if one.name == name]
        longest_s = max(one.wrong_s for one in mine)
        yield Figure(f"missed at: {name}", f"{len(mine)} logs, at most {longest_s:.1f} s")
