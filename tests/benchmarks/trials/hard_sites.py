"""What `hard_sites.py` measures."""

import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from bounds import Bound, Figure, held
from perception.hard_sites import HARD_SITES
from perception.piles import load_scenes
from perception.trials import RIGHT_M, RIGHT_RAD, registrar

from executive.geometry.rotation import angle_between


@dataclass(frozen=True, slots=True)
class Trial:
    """One registration.

    Attributes:
        kind, seed: Which site.
        accepted, is_right: The verdict, and whether the motion is that of the scene.
        error_m: At the middle of the site.
        cpu_ms: Processor time.
    """

    kind: str
    seed: int
    accepted: bool
    is_right: bool
    error_m: float
    cpu_ms: float


def measured(seeds: Iterable[int]) -> list[Trial]:
    """Register one site of each kind a seed; tell on standard error what was not right."""
    scenes, plugin, trials = load_scenes(), registrar(), []
    for seed in seeds:
        for kind, drawn in HARD_SITES.items():
            scene = drawn(scenes, seed)
            begun_s = time.process_time()
            found = plugin.register(scene.target, scene.source, np.random.default_rng(0))
            cpu_ms = 1e3 * (time.process_time() - begun_s)
            error_m = scene.errors(found.apply)[1]
            turn = angle_between(found.T_target_source[:3, :3], scene.T_target_source[:3, :3])
            is_right = error_m < RIGHT_M and turn < RIGHT_RAD
            trials.append(Trial(kind, seed, found.accepted, bool(is_right), error_m, cpu_ms))
            if not (found.accepted and is_right):
                print(f"{kind}, seed {seed}: {found.reason}", file=sys.stderr, flush=True)
    return trials


def figures(trials: Sequence[Trial]) -> list[Figure]:
    """Return the figures with their bounds, and the share of each kind beside them."""
    right = [t for t in trials if t.accepted and t.is_right]
    wrong = [t for t in trials if t.accepted and not t.is_right]
    each = [
        Figure(
            f"{kind}: registered rightly",
            f"{sum(t.kind == kind for t in right)} of {sum(t.kind == kind for t in trials)}",
        )
        for kind in HARD_SITES
    ]
    return [
        *each,
        held(
            "registered rightly [%]",
            100 * len(right) / len(trials),
            Bound(99.5, 100, is_least=True),
            f"{len(right)} of {len(trials)}",
        ),
        held("wrong motions accepted", len(wrong), Bound(0), f"{len(wrong)} of {len(trials)}"),
        held("median error [mm]", 1e3 * float(np.median([t.error_m for t in right])), Bound(10, 5)),
        Figure("median processor time [ms]", f"{np.median([t.cpu_ms for t in trials]):.0f}"),
    ]
