"""Registration on segments whose motions come from KISS-Matcher (Lim et al. 2025), at the gate of
the others.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from executive_plugins.registration.motion_proposer import MotionProposer
from executive_plugins.registration.segment_registrar import SegmentRegistrar
from executive_plugins.registration.settings import KissMatcherSettings
from executive_plugins.registration.stopwatch import Stopwatch

from executive.arrays import Float
from executive.extras import require_extra
from executive.geometry.pose import pose
from executive.interfaces.alignment import Aligner
from executive.interfaces.segmentation import Segmenter
from executive.messages.segment import Segmentation


@dataclass(frozen=True, slots=True)
class FasterPfh(MotionProposer):
    """Propose the one motion that KISS-Matcher finds between all segments' points."""

    feature_voxel_m: float

    def propose(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> list[Float]:
        """Return the package's motion, or none; see `MotionProposer.propose`.

        The package runs on one core: its threads add up in the order in which they finish, so that
        more of them would change the last bits. Two are no faster on clouds of this size.
        """
        matcher = _package().KISSMatcher(self.feature_voxel_m)
        here, there = (
            np.vstack([one.points for one in x.segments]).astype(np.float32)
            for x in (source, target)
        )
        with _one_core(), watch.stage("matching"):
            matched = matcher.match(list(here), list(there))
        with _one_core(), watch.stage("verification"):
            solution = matcher.prune_and_solve(*matched)
        if not solution.valid:
            return []
        return [
            pose(
                _orthonormal(np.asarray(solution.rotation)),
                np.asarray(solution.translation).ravel(),
            )
        ]


@contextmanager
def _one_core() -> Iterator[None]:
    """Let the calling thread see one core of those that it may use, until the block ends.

    A pool of threads that is made in here is made for one core, and stays so: sums come in one
    order.
    """
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)


def _orthonormal(R: Float) -> Float:
    """Return the rotation nearest to one that was told in single precision."""
    U, _, Vt = np.linalg.svd(R)
    return np.asarray(U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(R))]) @ Vt)


def _package() -> Any:
    require_extra("registration 'kiss_matcher'", "kiss")
    with _one_core():  # its thread pools are created when it is imported
        import kiss_matcher
    return kiss_matcher


class KissMatcher(SegmentRegistrar):
    """Registration by segments with KISS-Matcher; nothing is tried when it is refused."""

    Settings = KissMatcherSettings

    def __init__(
        self, settings: KissMatcherSettings, segmentation: Segmenter, alignment: Aligner
    ) -> None:
        super().__init__(settings, segmentation, alignment)
        self._proposer = FasterPfh(settings.feature_voxel_m)

    def start(self) -> None:
        """Find the package, so that a missing one is told before the robot starts.

        Raises:
            MissingExtraError: If it is not installed.
        """
        _package()
        super().start()

    def _proposers(self) -> tuple[MotionProposer, ...]:
        return (self._proposer,)
