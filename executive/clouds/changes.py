"""What came and what went between two clouds of one site, by what each of them shows.

A thing is gone where the later cloud shows lower ground in its place; where the later cloud shows
nothing, as behind an occluder, nobody knows. The same the other way round tells what came.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from executive.arrays import Bool, Float
from executive.errors import DataError

_CELL_M = 0.1  # edge of the squares in which heights are compared
_LEAST_SEEN = 0.5  # share of a thing's squares that the other cloud has to show, for a verdict
_LEAST_SHARED = 0.1  # share of the smaller site's square metres that both clouds have to show


class Standing(StrEnum):
    """Whether a thing of one cloud stands in the other one, too."""

    STAYED = "stayed"
    ABSENT = "absent"
    UNSEEN = "unseen"


@dataclass(frozen=True, slots=True)
class Verdict:
    """What another cloud says of a thing.

    Attributes:
        standing: Whether it stands there, too.
        seen: Share of the thing's squares that the other cloud shows.
        lower: Share of those in which the other cloud's surface is lower than the thing.
    """

    standing: Standing
    seen: float
    lower: float


class HeightMap:
    """The highest points of a cloud in squares of 10 cm, z up."""

    def __init__(self, points: Float) -> None:
        """Take the cloud in [m], shape (N, 3).

        Raises:
            DataError: If it is empty.
        """
        if not len(points):
            raise DataError("a cloud without points shows no site: nothing can be compared")
        self._low = np.floor(points[:, :2].min(axis=0) / _CELL_M).astype(np.int64)
        cells = np.floor(points[:, :2] / _CELL_M).astype(np.int64) - self._low
        self._tops = np.full(cells.max(axis=0) + 1, -np.inf)
        np.maximum.at(self._tops, tuple(cells.T), points[:, 2])

    def at(self, places: Float) -> Float:
        """Return the highest z in the square of each place [m], (N, 2) → (N,); −inf if unseen."""
        cells = np.floor(places / _CELL_M).astype(np.int64) - self._low
        inside = ((cells >= 0) & (cells < self._tops.shape)).all(axis=1)
        heights = np.full(len(cells), -np.inf)
        heights[inside] = self._tops[tuple(cells[inside].T)]
        return heights

    def shows(self, places: Float) -> Bool:
        """Return in which squares of the places (N, 2) this cloud has a point, shape (N,)."""
        return np.isfinite(self.at(places))


def check_overlap(earlier: Float, later: Float) -> None:
    """Refuse clouds that hardly show the same ground [m], each (N, 3).

    Raises:
        DataError: If fewer than a tenth of the smaller one's square metres are in both.
    """
    metres = [{*map(tuple, np.floor(one[:, :2]).astype(np.int64))} for one in (earlier, later)]
    shared, smaller = len(metres[0] & metres[1]), min(map(len, metres))
    if shared < max(_LEAST_SHARED * smaller, 1):
        raise DataError(
            f"the clouds share {shared} of {smaller} square metres: they are not in one frame, or "
            "show other sites; `executive register LATER EARLIER --json` gives the pose for --guess"
        )


def verdicts(things: Sequence[Float], other: HeightMap, noise_m: float) -> list[Verdict]:
    """Say for each thing of one cloud whether it stands in another one, too.

    A square speaks if the thing is there higher above its own foot than the noise: at its rim the
    ground and the thing are alike. It is lower in the other cloud if that has its highest point
    below the middle between the thing's top and its foot.

    Args:
        things: Points of each [m], shape (N, 3).
        other: The other cloud, in the same frame.
        noise_m: Three standard deviations of heights, noise and misalignment together [m].
    """
    return [_verdict(points, other, noise_m) for points in things]


def _verdict(points: Float, other: HeightMap, noise_m: float) -> Verdict:
    own, foot_m = HeightMap(points), float(points[:, 2].min())
    cells = np.unique(np.floor(points[:, :2] / _CELL_M), axis=0)
    places = (cells + 0.5) * _CELL_M
    tops = own.at(places)
    places, tops = places[tops > foot_m + 2 * noise_m], tops[tops > foot_m + 2 * noise_m]
    heights = other.at(places)
    shown = np.isfinite(heights)
    if len(places) == 0 or shown.mean() < _LEAST_SEEN:
        return Verdict(Standing.UNSEEN, float(shown.mean()) if len(places) else 0.0, 0.0)
    lower = float((heights < 0.5 * (tops + foot_m))[shown].mean())
    standing = Standing.ABSENT if lower > 0.5 else Standing.STAYED
    return Verdict(standing, float(shown.mean()), lower)
