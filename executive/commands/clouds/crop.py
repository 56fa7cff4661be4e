"""The part of a cloud that a command is to look at."""

from pathlib import Path
from typing import TYPE_CHECKING

from executive.errors import ConfigError, DataError

if TYPE_CHECKING:
    from executive.arrays import Bool, Float
    from executive.messages.cloud import Cloud

_FORMS = "x,y,radius or x_low,y_low,x_high,y_high, in the cloud's coordinates [m]"


class Crop:
    """A circle or a rectangle seen from above; without words the whole cloud.

    Args:
        words: What was given, if anything was.
        option: The option that it was given to, for messages.

    Raises:
        ConfigError: If the words are neither three nor four numbers, or hold no area.
    """

    def __init__(self, words: str | None, option: str = "--crop") -> None:
        try:
            numbers = [float(word) for word in words.split(",")] if words is not None else []
        except ValueError as error:
            raise ConfigError(f"{option}: '{words}' is not {_FORMS}") from error
        is_circle = len(numbers) == 3 and numbers[2] > 0
        is_box = len(numbers) == 4 and numbers[0] < numbers[2] and numbers[1] < numbers[3]
        if words is not None and not is_circle and not is_box:
            raise ConfigError(f"{option}: '{words}' is not {_FORMS}")
        self._words, self._numbers, self._option = words, numbers, option

    def of(self, cloud: "Cloud") -> "Cloud":
        """Return the part of a cloud, without normals.

        Raises:
            DataError: If no point is in it.
        """
        from executive.messages.cloud import Cloud

        if not self._numbers:
            return cloud
        return Cloud(cloud.frame, cloud.points[self.inside(cloud.points)])

    def of_site(self, path: Path, name: str, points: "Float", widest_m: float | None) -> "Cloud":
        """Return the part of a file's points that is a site.

        Args:
            path: The file, for messages.
            name: Of the cloud's frame.
            points: Its points [m], shape (N, 3).
            widest_m: Largest width of the part [m]; None for the usual one.

        Raises:
            DataError: If no point is in it, or it is no site in metres.
        """
        from executive.clouds.units import check_site
        from executive.messages.cloud import Cloud

        try:
            site = self.of(Cloud(name, points))
        except DataError as error:
            raise DataError(f"{path}: {error}") from error
        check_site(path, site.points, widest_m)
        return site

    def inside(self, points: "Float") -> "Bool":
        """Return which points are in the area, shape (N,).

        Args:
            points: Points [m], shape (N, 3).

        Raises:
            DataError: If none is.
        """
        import numpy as np

        numbers, xy = self._numbers, points[:, :2]
        if not numbers:
            return np.ones(len(points), dtype=bool)
        if len(numbers) == 3:
            kept = np.hypot(*(xy - numbers[:2]).T) < numbers[2]
        else:
            kept = ((xy >= numbers[:2]) & (xy <= numbers[2:])).all(axis=1)
        if not kept.any():
            spans = " and ".join(
                f"{name} from {low:.6g} to {high:.6g} m"
                for name, low, high in zip("xy", xy.min(axis=0), xy.max(axis=0), strict=True)
            )
            raise DataError(f"{self._option}: no point is in {self._words}; the cloud has {spans}")
        return np.asarray(kept)
