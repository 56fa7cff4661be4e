"""The scenarios: which motion, what goes wrong, and the figures that come of each trial."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from scenarios import faults
from scenarios.faults import Fault
from scenarios.motion import Kind
from scenarios.outage import backs_s, drift_share, odometry_share
from scenarios.trial import Trial

ALL = (Kind.STANDING, Kind.DRIVING, Kind.SWINGING)
MOVING = (Kind.DRIVING, Kind.SWINGING)
READY_S = 12.0  # faults begin after this; the machine moves from 6 s on
DATUM_CHANGE_M = 5.0
Figures = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Scenario:
    """One kind of trial.

    Attributes:
        kinds: Motions, taken in turn over the seeds.
        end_s: Duration [s].
        fault: Draws what goes wrong with the fixes.
        figures: What a trial is worth, by the name of the figure.
        lidar: Whether there is lidar odometry.
        settings: Settings of the estimators that are not at their default.
    """

    kinds: tuple[Kind, ...]
    end_s: float
    fault: Callable[[np.random.Generator], Fault]
    figures: Callable[[Trial], Figures]
    lidar: bool = True
    settings: Mapping[str, object] = field(default_factory=dict)


def _clean(trial: Trial) -> Figures:
    fixed = trial.stamps_s > 1.0
    rejected = sum(n for reason, n in trial.refused.items() if "gnss" in reason)
    nees = trial.nees()
    return {
        "clean: rejected": 100 * rejected / trial.fixes,
        "clean: not global": 100 * (1 - trial.is_global[fixed].mean()),
        "position: distance": 100 * trial.off_m.mean(),
        "position: bias": 100 * float(np.linalg.norm(trial.antenna_error_m.mean(axis=0))),
        "position: std": 100 * float(trial.antenna_error_m.std(axis=0).mean()),
        "consistency: mean": 100 * trial.consistency_m.mean(),
        "consistency: std": 100 * trial.consistency_m.std(),
        "nees: inside": 100 * float((nees < 16.81).mean()),  # χ², 6 degrees of freedom, 99 %
        "nees: mean": float(nees.mean()),
    }


def _worst_error(name: str) -> Callable[[Trial], Figures]:
    def figures(trial: Trial) -> Figures:
        return {f"{name}: error": 100 * trial.off_m[trial.stamps_s > READY_S].max()}

    return figures


def _plateau(trial: Trial) -> Figures:
    during = trial.stamps_s > READY_S
    return {
        "plateau: error": 100 * trial.off_m[during].max(),
        "plateau: back": backs_s(trial, READY_S + 5.0),
        "plateau: step": 1000 * trial.odometry_step_m[during[1:]].max(),
    }


def _ramp(trial: Trial) -> Figures:
    during = (trial.stamps_s > READY_S) & (trial.stamps_s < READY_S + 20.0)
    after = trial.stamps_s > READY_S
    flagged = ~trial.is_global[during]
    first_s = trial.stamps_s[during][flagged][0] - READY_S if flagged.any() else np.inf
    return {"ramp: flagged": float(first_s), "ramp: error": 100 * trial.off_m[after].max()}


def _datum(trial: Trial) -> Figures:
    """The datum changes permanently: from then on the fixes define the truth."""
    after = trial.stamps_s > READY_S
    shift = trial.error_m[-1]
    anew = np.linalg.norm(trial.error_m[after] - shift, axis=1) < 0.1
    there = abs(float(np.linalg.norm(shift)) - DATUM_CHANGE_M) < 0.1
    since_s = trial.stamps_s[after][~anew][-1] - READY_S if there and not anew.all() else np.inf
    return {
        "datum: anchored": float(since_s),
        "datum: flagged": float(not trial.is_global[after].all()),
    }


def _outage(name: str, from_s: float, to_s: float) -> Callable[[Trial], Figures]:
    def figures(trial: Trial) -> Figures:
        during = trial.stamps_s > from_s
        return {
            f"{name}: share": 100 * drift_share(trial, from_s, to_s),
            f"{name}: beyond": 100
            * (drift_share(trial, from_s, to_s) - odometry_share(trial, from_s, to_s)),
            f"{name}: step": 1000 * trial.odometry_step_m[during[1:]].max(),
            f"{name}: back": backs_s(trial, to_s),
        }

    return figures


def _of_outage(duration_s: float) -> Scenario:
    """Lidar alone carries the estimate: the knowledge that the chassis is at rest is not used."""
    to_s = READY_S + duration_s
    return Scenario(
        MOVING,
        to_s + 4.0,
        lambda rng: faults.outage(READY_S, to_s),
        _outage(f"outage {duration_s:.0f} s", READY_S, to_s),
        settings={"standing": {"is_used": False}},
    )


SCENARIOS: Mapping[str, Scenario] = {
    "spikes": Scenario(
        ALL,
        32.0,
        lambda rng: faults.spikes(rng, (12.0, 15.0, 18.0, 22.0, 25.0, 28.0)),
        _worst_error("spikes"),
    ),
    "plateau": Scenario(
        ALL, 22.0, lambda rng: faults.plateau(rng, 1.0, READY_S, READY_S + 5.0), _plateau
    ),
    "ramp": Scenario(ALL, 38.0, lambda rng: faults.ramp(rng, 0.1, 2.0, READY_S), _ramp),
    "datum": Scenario(
        ALL, 30.0, lambda rng: faults.plateau(rng, DATUM_CHANGE_M, READY_S, np.inf), _datum
    ),
    "clean": Scenario(ALL, 40.0, lambda rng: faults.none, _clean),
    "clean_no_lidar": Scenario(
        ALL, 30.0, lambda rng: faults.none, lambda t: _renamed("no lidar", _clean(t)), lidar=False
    ),
    "wander": Scenario(
        ALL, 40.0, lambda rng: faults.wander(rng, 0.01), lambda t: _renamed("wander", _clean(t))
    ),
    "outage_45": _of_outage(45.0),
    "outage_160": _of_outage(160.0),
}


def _renamed(what: str, figures: Figures) -> Figures:
    return {f"{what}, {name}": value for name, value in figures.items()}
