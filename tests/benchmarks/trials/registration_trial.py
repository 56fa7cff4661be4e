"""One registration of a benchmark: how it was judged, and what it took."""

import time
from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, transform
from executive.interfaces.registration import Registrar
from executive.messages.cloud import Cloud

RIGHT_M = 0.10  # at the middle of the site and at its corners


@dataclass(frozen=True, slots=True)
class Trial:
    """One registration.

    Attributes:
        kind: Which kind of site.
        accepted, is_right: The verdict, and whether the motion is that of the scene.
        cpu_ms: Processor time.
        ratio: Likelihood of the rival in that of the answer; 0 if there is none.
    """

    kind: str
    accepted: bool
    is_right: bool
    cpu_ms: float
    ratio: float


def tried(plugin: Registrar, kind: str, target: Cloud, source: Cloud, T: Float | None) -> Trial:
    """Register once; without a true motion nothing is right."""
    begun_s = time.process_time()
    found = plugin.register(target, source, np.random.default_rng(0))
    cpu_ms = 1e3 * (time.process_time() - begun_s)
    is_right = False
    if T is not None:
        corners = target.points[:: max(len(target) // 500, 1)]
        apart = found.apply(transform(inverse(T), corners)) - corners
        is_right = bool(np.linalg.norm(apart, axis=1).max() < RIGHT_M)
    ratio = found.rival.likelihood_ratio if found.rival else 0.0
    return Trial(kind, found.accepted, is_right, cpu_ms, ratio)
