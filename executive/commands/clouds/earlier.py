"""An earlier cloud of a site, by which what came since is told as moving."""

from pathlib import Path
from typing import TYPE_CHECKING

from executive.clouds.changes import HeightMap, Standing, check_overlap, verdicts
from executive.clouds.reader import read_site
from executive.messages.segment import PartKind

if TYPE_CHECKING:
    from executive.arrays import Float
    from executive.messages.segment import Segmentation

NOISE_M = 0.06  # three standard deviations of heights, noise and misfit of the clouds together


class EarlierCloud:
    """Tells what came since a cloud was taken.

    Args:
        path: Its file, in the coordinates of the later cloud.
        widest_m: Largest width of it [m]; None for the usual one.

    Raises:
        DataError: If it cannot be read.
    """

    def __init__(self, path: Path, widest_m: float | None) -> None:
        self._name, self._points = path.name, read_site(path, widest_m)
        self._heights = HeightMap(self._points)

    def with_moving(self, found: "Segmentation", points: "Float") -> "Segmentation":
        """Return a segmentation with what came told as moving.

        Args:
            found: The segmentation of a later cloud.
            points: That cloud's points [m], shape (N, 3).

        Raises:
            DataError: If the two hardly show the same ground.
        """
        check_overlap(self._points, points)
        return found.leaving_out(PartKind.MOVING, self._reason)

    def _reason(self, points: "Float") -> str:
        (verdict,) = verdicts([points], self._heights, NOISE_M)
        if verdict.standing is not Standing.ABSENT:
            return ""
        return f"{self._name} shows lower ground at {verdict.lower:.0%} of what it shows of it"
