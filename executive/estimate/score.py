"""An estimated trajectory against a reference: absolute and relative errors, covariance, outages.

Source: the measures of Sturm et al. 2012 (APE and RPE) and Zhang and Scaramuzza 2018 (alignment by
the gauge that an estimator leaves open), and of Bar-Shalom et al. 2001, Sec. 5.4 (NEES).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from executive.arrays import Float
from executive.errors import DataError
from executive.estimate.estimator_run import Estimated
from executive.estimate.material import Material
from executive.estimate.silence import silences
from executive.estimate.trajectory import Trajectory
from executive.geometry import chi_square
from executive.messages.base_state import BaseState

Indices = NDArray[np.intp]
ALIGNMENTS = ("none", "yaw", "se3")
_RELATIVE_S = (1.0, 10.0)
_SHARE = 0.95


@dataclass(frozen=True, slots=True, eq=False)
class Scored:
    """The estimate at the stamps of the reference.

    Attributes:
        stamps_s: Times since 1970 [s], shape (n,).
        estimate: Poses of the estimate.
        reference: Poses of the reference, aligned.
        covariance: Of the estimate's poses as (rotation, translation) in the body, (n, 6, 6).
        status: Status of the estimate, n of them.
    """

    stamps_s: Float
    estimate: Trajectory
    reference: Trajectory
    covariance: Float
    status: tuple[str, ...]

    @property
    def distance_m(self) -> Float:
        """Distance of the positions [m], shape (n,)."""
        return np.asarray(np.linalg.norm(self.estimate.p - self.reference.p, axis=1))


def scored(
    states: Sequence[BaseState], origin_s: float, reference: Trajectory, alignment: str
) -> Scored:
    """Lay an estimate beside a reference.

    Args:
        states: States of the estimator; those without a heading are left out.
        origin_s: Time since 1970 from which their stamps count [s].
        reference: Poses of the cabin, or of the only body there is.
        alignment: `none`, `yaw` (a heading and a shift) or `se3` (a rotation and a shift) by which
            the reference is laid over the estimate.

    Raises:
        DataError: If they have fewer than three times in common.
    """
    ready = [state for state in states if state.is_ready]
    if len(ready) < 2:
        raise DataError("--score: the estimate has no state with a heading to be scored")
    stamps = origin_s + np.array([state.stamp_s for state in ready])
    T = np.stack([state.T_map_cabin for state in ready])
    track = Trajectory(stamps, T[:, :3, 3], T[:, :3, :3])
    common = reference.stamps_s[track.covers(reference.stamps_s)]
    if len(common) < 3:
        ends = f"{reference.stamps_s[0]:.3f} to {reference.stamps_s[-1]:.3f} s"
        raise DataError(
            f"--score: reference and estimate have {len(common)} times in common; the reference is "
            f"of {ends}, the estimate of {stamps[0]:.3f} to {stamps[-1]:.3f} s since 1970"
        )
    estimate, beside = track.at(common), reference.at(common)
    nearest = [ready[i] for i in np.searchsorted(stamps, common) - 1]
    covariance = np.stack([state.covariance for state in nearest])
    status = tuple(state.status for state in nearest)
    return Scored(common, estimate, _aligned(beside, estimate, alignment), covariance, status)


def _aligned(reference: Trajectory, estimate: Trajectory, alignment: str) -> Trajectory:
    """Return the reference, moved by the least squares of the positions (Umeyama 1991)."""
    if alignment == "none":
        return reference
    middle, to = reference.p.mean(axis=0), estimate.p.mean(axis=0)
    M = (estimate.p - to).T @ (reference.p - middle)
    if alignment == "yaw":
        yaw = np.arctan2(M[1, 0] - M[0, 1], M[0, 0] + M[1, 1])
        R = Rotation.from_euler("z", yaw).as_matrix()
    else:
        U, _, Vt = np.linalg.svd(M)
        R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return Trajectory(reference.stamps_s, (reference.p - middle) @ R.T + to, R @ reference.R)


def report(pair: Scored, alignment: str, silences: Sequence[tuple[float, float]]) -> dict[str, Any]:
    """Return the figures, ready for JSON.

    Args:
        pair: Estimate and reference.
        alignment: How they were aligned.
        silences: Times since 1970 [s] between which there were no fixes.
    """
    has_turn = pair.reference.has_orientation
    turn = np.swapaxes(pair.estimate.R, 1, 2) @ pair.reference.R
    angle = Rotation.from_matrix(turn).magnitude()
    return {
        "alignment": alignment,
        "poses": len(pair.stamps_s),
        "from_s": round(float(pair.stamps_s[0]), 3),
        "to_s": round(float(pair.stamps_s[-1]), 3),
        "ape_m": _figures(pair.distance_m),
        "ape_rad": _figures(angle) if has_turn else None,
        "rpe": {f"{over_s:g} s": _relative(pair, over_s, has_turn) for over_s in _RELATIVE_S},
        "nees": _nees(pair, has_turn),
        "outages": [one for silence in silences if (one := _outage(pair, *silence))],
    }


def with_score(
    material: Material, estimated: Estimated, reference: Trajectory, alignment: str
) -> Estimated:
    """Add the score of an estimate to its report.

    Raises:
        DataError: If estimate and reference have no times in common.
    """
    origin_s = 1e-9 * material.log.origin_ns
    pair = scored(estimated.replay.states, origin_s, reference, alignment)
    apart = [(origin_s + from_s, origin_s + to_s) for from_s, to_s in silences(material)]
    figures = report(pair, alignment, apart)
    return replace(estimated, report=estimated.report | {"score": figures})


def summary(figures: Mapping[str, Any]) -> str:
    """Return the score in one line, for people."""
    ape, nees = figures["ape_m"], figures["nees"]
    return (
        f"score over {figures['poses']} poses, alignment {figures['alignment']}: APE rms "
        f"{ape['rms']:.3f} m, median {ape['median']:.3f} m, 95 % {ape['p95']:.3f} m; "
        f"{100 * nees['inside_95']:.0f} % of the errors within the 95 % bound of the covariance; "
        f"{len(figures['outages'])} times without fixes"
    )


def _figures(values: Float) -> Mapping[str, float | int] | None:
    if not len(values):
        return None
    return {
        "rms": round(float(np.sqrt(np.mean(values**2))), 5),
        "median": round(float(np.median(values)), 5),
        "p95": round(float(np.percentile(values, 95)), 5),
        "max": round(float(values.max()), 5),
        "n": len(values),
    }


def _relative(pair: Scored, over_s: float, has_turn: bool) -> dict[str, Any]:
    """Return the error of the motion over a time, in the body's axes at its beginning."""
    ends = np.searchsorted(pair.stamps_s, pair.stamps_s + over_s - 1e-6)
    begins = np.flatnonzero(ends < len(pair.stamps_s))
    ends = ends[begins]
    near = pair.stamps_s[ends] - pair.stamps_s[begins] < 1.5 * over_s  # no gap in between
    begins, ends = begins[near], ends[near]
    moved = [_motion(one, begins, ends) for one in (pair.estimate, pair.reference)]
    if not has_turn:  # lengths alone can be compared
        lengths = [np.linalg.norm(shift, axis=1) for shift, _ in moved]
        return {"m": _figures(np.abs(lengths[0] - lengths[1])), "rad": None}
    (shift, turn), (shift_reference, turn_reference) = moved
    angle = Rotation.from_matrix(np.swapaxes(turn, 1, 2) @ turn_reference).magnitude()
    return {
        "m": _figures(np.linalg.norm(shift - shift_reference, axis=1)),
        "rad": _figures(np.asarray(angle)),
    }


def _motion(one: Trajectory, begins: Indices, ends: Indices) -> tuple[Float, Float]:
    R_back = np.swapaxes(one.R[begins], 1, 2)
    shift = np.einsum("nij,nj->ni", R_back, one.p[ends] - one.p[begins])
    return shift, R_back @ one.R[ends]


def _nees(pair: Scored, has_turn: bool) -> dict[str, Any]:
    """Return how far the errors are within what their covariance promises."""
    R_back = np.swapaxes(pair.estimate.R, 1, 2)
    shift = np.einsum("nij,nj->ni", R_back, pair.reference.p - pair.estimate.p)
    turn = Rotation.from_matrix(R_back @ pair.reference.R).as_rotvec()
    error = np.concatenate([turn, shift], axis=1) if has_turn else shift
    degrees = error.shape[1]
    P = pair.covariance[:, 6 - degrees :, 6 - degrees :]
    nees = np.einsum("ni,ni->n", error, np.linalg.solve(P, error[:, :, None])[:, :, 0])
    inside = nees <= chi_square.quantile(_SHARE, degrees)
    return {
        "degrees": degrees,
        "inside_95": round(float(inside.mean()), 4),
        "median_over_expected": round(float(np.median(nees) / chi_square.median(degrees)), 3),
    }


def _outage(pair: Scored, from_s: float, to_s: float) -> dict[str, Any] | None:
    inside = np.flatnonzero((pair.stamps_s >= from_s) & (pair.stamps_s < to_s))
    if not len(inside):
        return None
    distance_m = pair.distance_m[inside]
    way_m = np.linalg.norm(np.diff(pair.reference.p[inside], axis=0), axis=1).sum()
    return {
        "from_s": round(from_s, 3),
        "to_s": round(to_s, 3),
        "error_at_end_m": round(float(distance_m[-1]), 4),
        "max_error_m": round(float(distance_m.max()), 4),
        "way_m": round(float(way_m), 2),
        "status_at_end": pair.status[inside[-1]],
    }
