"""How likely what the map shows is the surface of a known stone, and not that of another one."""

from dataclasses import dataclass

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.geometry.normals import outward_normals
from executive.messages.cloud import Cloud

_PATCH_M = 0.10  # radius of a patch: the mean of some twenty points is nearly free of their noise
_UPPER = 0.5  # share of a model's height below which points beside it may be of the ground
_FORM_M = 0.01  # height of a patch within which it shows the same form: surveys are bent as much
_CLUTTER_M = 0.06  # from which a patch is of something else beside the stone
# Shares of patches that are of the same form, of another form, and of something else, where the
# map shows the known stone, and where it shows another one onto which the model was aligned. The
# latter is the mean of 120 such fits (`stacked_stones.py`, seeds 700 to 739: 0.55, 0.29, 0.16). Of
# 40 right fits 0.9995 of the patches were alike; the former leaves room for clutter: the worst of
# seven placed stones of a mission had 0.971, 0.006, 0.023.
_KNOWN, _OTHER = np.array([0.95, 0.01, 0.04]), np.array([0.55, 0.30, 0.15])
_GAIN = np.log(_KNOWN / _OTHER)
ALIKE_OF_ANOTHER = float(_OTHER[0])  # share of patches that are alike where another stone lies


class FormSettings(Settings):
    max_distance: Meters = Field(
        0.3,
        gt=0,
        le=2,
        description="Farthest correspondence; what the map shows farther from the model is not "
        "compared with it [m].",
    )
    min_likelihood: float = Field(
        1e3,
        gt=1,
        description="How many times likelier what the map shows has to be as the surface of the "
        "known stone than as that of another one. Alignment and registration ask whether the map "
        "shows the model; this asks whether it shows something else there.",
    )


@dataclass(frozen=True, slots=True)
class FormEvidence:
    """What the map's patches beside a fitted model say.

    Attributes:
        log_ratio: Natural logarithm of how much likelier they are of the known stone than of
            another one.
        alike: Share of the patches that show the form of the model.
    """

    log_ratio: float
    alike: float


def form_refusal(
    around: Cloud, model: Float, settings: FormSettings, is_expected: bool = False
) -> str:
    """Say why what the map shows is not the surface of a fitted model; empty if it is.

    It computes for tenths of a second: call it as a job, as `is_refuted` and `form_evidence`.

    Args:
        around: The map without what other known stones explain.
        model: The fitted model in the map [m], shape (M, 3).
        settings: How likely the form has to be.
        is_expected: Whether this stone was put there. Then it is enough that the map shows the
            surface of the stone that is known. What else it shows there may be a side of the stone
            that nobody had seen: of 40 stones on two others, known from two sides, the whole form
            tells 16, the known surface 34, and of 120 that had rolled over there none is taken for
            one that stands (`stacked_stones.py`, seeds 7700 to 7739).
    """
    sure, reach_m = np.log(settings.min_likelihood), settings.max_distance
    form = form_evidence(around.points, model, reach_m)
    if form.log_ratio >= sure:
        return ""
    told = f"{form.alike:.0%} of what the map shows there has the form of the model"
    if not is_expected:
        return told
    own = _own_evidence(around.points, model, reach_m)
    return "" if own.log_ratio >= sure else f"{told}, and so has {own.alike:.0%} of its own surface"


def is_refuted(around: Cloud, model: Float, settings: FormSettings) -> bool:
    """Return whether the map shows something else than a stone at its place, or nothing.

    A map of few points confirms no stone and refutes none: that most of what it shows has the form
    of the stone, which is more than where another one lies, leaves the stone in doubt. So does
    something else beside it, such as a stone that fell and lies there unknown, as long as the map
    shows the form of the stone where the stone's own surface is.

    Args:
        around: The map without what other known stones explain.
        model: The stone's surface where it is believed to be [m], shape (M, 3).
        settings: How likely the form has to be.
    """
    form = form_evidence(around.points, model, settings.max_distance)
    sure = np.log(settings.min_likelihood)
    if form.alike > ALIKE_OF_ANOTHER and form.log_ratio >= -sure:
        return False
    own = _own_evidence(around.points, model, settings.max_distance)
    return bool(own.alike <= ALIKE_OF_ANOTHER or own.log_ratio < sure)


def form_evidence(points: Float, model: Float, reach_m: float, hangs: bool = False) -> FormEvidence:
    """Compare what the map shows beside the upper half of a fitted model with that model.

    Each patch is an observation: its mean height above the model is free of the points' noise and
    of the gaps between them. Patches overlap, so that each point counts as the share of a patch
    that it is. Noise of single points is a centimetre or two, as large as the difference between
    two stones: shares of points within some distance tell stones apart badly. Ours, not the
    paper's, which accepts what ICP accepts.

    Args:
        points: Points of the map, without those that other known stones explain [m], shape (N, 3).
        model: The fitted model in the map [m], shape (M, 3).
        reach_m: Points farther from the model are not beside it [m].
        hangs: Whether the stone hangs free, so that all around it counts: nothing is of the ground.
    """
    from scipy.spatial import cKDTree  # reading a mission imports no algorithm

    upper = points if hangs else points[points[:, 2] > _middle_m(model)]
    distances, feet = cKDTree(model).query(upper, distance_upper_bound=reach_m)
    beside = np.isfinite(distances)
    if not beside.any():
        return FormEvidence(0.0, 0.0)
    seen, feet = upper[beside], feet[beside]
    normals = outward_normals(model, model.mean(axis=0))[feet]
    return _judged(seen, np.einsum("ij,ij->i", seen - model[feet], normals))


def _own_evidence(points: Float, model: Float, reach_m: float) -> FormEvidence:
    """Compare the upper half of a model with the map where the map shows its surface.

    What lies beside the stone does not count, unless it hides it.
    """
    from scipy.spatial import cKDTree

    is_upper = model[:, 2] > _middle_m(model)
    upper = model[is_upper]
    if not len(points) or not len(upper):
        return FormEvidence(0.0, 0.0)
    distances, nearest = cKDTree(points).query(upper, distance_upper_bound=reach_m)
    is_near = np.isfinite(distances)
    normals = outward_normals(model, model.mean(axis=0))[is_upper][is_near]
    offsets = points[nearest[is_near]] - upper[is_near]
    heights = np.einsum("ij,ij->i", offsets, normals)
    aside_m = np.sqrt(np.maximum(distances[is_near] ** 2 - heights**2, 0.0))
    shown = aside_m <= _PATCH_M
    if not shown.any():
        return FormEvidence(0.0, 0.0)
    return _judged(upper[is_near][shown], heights[shown])


def _middle_m(model: Float) -> float:
    """Return the height above which all is of the stone, and not of the ground [m]."""
    return float(model[:, 2].min() + _UPPER * np.ptp(model[:, 2]))


def _judged(at: Float, heights: Float) -> FormEvidence:
    """Return what patches of points (N, 3) with heights (N,) above a surface [m] say."""
    from scipy.spatial import cKDTree

    patches = cKDTree(at).query_ball_point(at, _PATCH_M)
    means = np.abs([heights[patch].mean() for patch in patches])
    weights = np.array([1.0 / len(patch) for patch in patches])
    kinds = np.digitize(means, (_FORM_M, _CLUTTER_M))
    alike = float(weights[kinds == 0].sum() / weights.sum())
    return FormEvidence(float(weights @ _GAIN[kinds]), alike)
