"""A cloud with what its file says besides: colour, intensity, coordinate system, grid."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.arrays import Bool, Float, Int


@dataclass(frozen=True, slots=True)
class Place:
    """Where on Earth a cloud is, and how its file stores coordinates.

    Attributes:
        crs: Name of the coordinate system, as `coordinate_system` gives it; empty if unknown.
        records: Numbers and contents of a LAS file's own records of it: WKT or GeoTIFF keys.
        scales: Steps of the coordinates of a LAS file [m], shape (3,); empty of other files.
        offsets: Where these steps begin [m], shape (3,).
    """

    crs: str = ""
    records: tuple[tuple[int, bytes], ...] = ()
    scales: tuple[float, ...] = ()
    offsets: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class FileCloud:
    """Points of a file, and what it says of them.

    Attributes:
        points: Coordinates [m], shape (N, 3).
        colour: Red, green and blue, integers of 8 or 16 bits, shape (N, 3); or None.
        intensity: Strength of the returns in the file's own unit, shape (N,); or None.
        place: Where the cloud is.
        left_out: Names of the file's fields that were not read.
    """

    points: Float
    colour: NDArray[Any] | None = None
    intensity: NDArray[np.float32] | None = None
    place: Place = Place()
    left_out: tuple[str, ...] = ()

    @classmethod
    def of(
        cls, points: Float, carried: np.ndarray | None, left_out: tuple[str, ...]
    ) -> "FileCloud":
        """Return a cloud whose colour and intensity are the fields `colour` and `intensity`."""
        names = () if carried is None else carried.dtype.names or ()
        colour = carried["colour"] if carried is not None and "colour" in names else None
        intensity = carried["intensity"] if carried is not None and "intensity" in names else None
        return cls(points, colour, intensity, left_out=left_out)

    def __len__(self) -> int:
        return len(self.points)

    def only(self, kept: Bool | Int) -> "FileCloud":
        """Return some of the points, by a mask of shape (N,) or by rows."""
        return replace(
            self,
            points=self.points[kept],
            colour=None if self.colour is None else self.colour[kept],
            intensity=None if self.intensity is None else self.intensity[kept],
        )

    def moved(self, T: Float, scale: float, crs: str) -> "FileCloud":
        """Return the cloud in another frame: p ↦ R (scale · p) + t.

        Args:
            T: R and t [m], shape (4, 4).
            scale: Scale of the points.
            crs: Coordinate system of the other frame; empty if it has none.
        """
        points = scale * (self.points @ T[:3, :3].T) + T[:3, 3]
        return replace(self, points=points, place=Place(crs))

    def colour_8(self) -> NDArray[np.uint8]:
        """Return the colour in 8 bits a channel, shape (N, 3).

        Many programs write 8 bits into the 16 of a LAS file without normalising them: if no
        channel of any point is above 255, the values stay as they are.

        Raises:
            ValueError: If there is no colour.
        """
        if self.colour is None:
            raise ValueError("the cloud has no colour")
        if self.colour.dtype == np.uint8 or self.colour.max(initial=0) <= 255:
            return self.colour.astype(np.uint8)
        return (self.colour >> 8).astype(np.uint8)

    def rounding_to_8(self) -> tuple[str, ...]:
        """Return what `colour_8` loses, for people."""
        if self.colour is None or self.colour.max(initial=0) <= 255:
            return ()
        is_kept = np.array_equal(self.colour_8().astype(np.uint16) * 257, self.colour)
        return () if is_kept else ("colours of 16 bits are cut to 8",)
