"""What a file says of each point besides its place and is carried with it: colour, intensity."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from executive.errors import DataError

_COLOURS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
_PACKED = ("rgb", "rgba")  # 0xRRGGBB in 32 bits
_INTENSITIES = ("intensity", "scalar_intensity")  # the second is written by CloudCompare
_DEPTHS = ("u1", "u2")  # integers of 8 or 16 bits


@dataclass(frozen=True, slots=True)
class CarriedFields:
    """Names of the fields of a file that are carried.

    Attributes:
        colour: Fields of red, green and blue; or one field that holds all three in an integer, as
            PCD files have it; or none.
        depth: NumPy's type of a channel of the colour, `u1` or `u2`.
        intensity: Field of the intensity; empty if there is none.
        is_float: Whether the one field of the colour is called a number in single precision, whose
            bits are the integer: older PCD files have it so.
    """

    colour: tuple[str, ...] = ()
    depth: str = "u1"
    intensity: str = ""
    is_float: bool = False

    @classmethod
    def of(cls, row: np.dtype) -> "CarriedFields":
        """Return those of a row of fields that are known by their names and types."""
        plain = {
            name.lower(): name for name in row.names or () if not row[name].shape
        }  # names differ in capitals from program to program
        colour: tuple[str, ...] = ()
        depth = "u1"
        for names in _COLOURS:
            kinds = {row[plain[name]].str[1:] for name in names if name in plain}
            if all(name in plain for name in names) and len(kinds) == 1 and kinds <= set(_DEPTHS):
                colour, (depth,) = tuple(plain[name] for name in names), kinds
                break
        packed = next((plain[name] for name in _PACKED if name in plain), "")
        if packed and not colour and row[packed].itemsize == 4:
            colour = (packed,)
        intensity = next((plain[name] for name in _INTENSITIES if name in plain), "")
        return cls(colour, depth, intensity, len(colour) == 1 and row[colour[0]].kind == "f")

    @property
    def names(self) -> tuple[str, ...]:
        """The fields that are read."""
        return (*self.colour, *([self.intensity] if self.intensity else []))

    @property
    def layout(self) -> np.dtype:
        """Type of what is carried with a point: `colour`, three integers, and `intensity`."""
        colour = [("colour", self.depth, (3,))] if self.colour else []
        return np.dtype([*colour, *([("intensity", "<f4")] if self.intensity else [])])

    def rows(self, path: Path, source: "Mapping[str, Any] | np.ndarray") -> np.ndarray:
        """Return what is carried of points, shape (N,), of type `layout`.

        Args:
            path: The file, for messages.
            source: Arrays by the names of the fields, shape (N,) each.

        Raises:
            DataError: If a colour is beyond its range.
        """
        rows = np.empty(len(source[self.names[0]]), self.layout)
        if self.intensity:
            with np.errstate(over="ignore", invalid="ignore"):  # infinite and NaN are carried
                rows["intensity"] = source[self.intensity]
        if len(self.colour) == 1:
            packed = self._packed(path, np.asarray(source[self.colour[0]]))
            for channel, shift in enumerate((16, 8, 0)):
                rows["colour"][:, channel] = (packed >> np.uint32(shift)) & np.uint32(0xFF)
        for channel, name in enumerate(self.colour if len(self.colour) == 3 else ()):
            rows["colour"][:, channel] = _checked(path, name, np.asarray(source[name]), self.depth)
        return rows

    def _packed(self, path: Path, values: np.ndarray) -> np.ndarray:
        """Return the integers that hold three channels, shape (N,)."""
        if self.is_float:
            with np.errstate(over="ignore", invalid="ignore"):
                return values.astype(np.float32).view(np.uint32)
        if values.dtype.kind == "i":  # the highest byte is not read: its sign does not count
            return values.view(np.uint32)
        return _checked(path, self.colour[0], values, "u4").astype(np.uint32)


def left_out(names: Sequence[str], carried: CarriedFields) -> tuple[str, ...]:
    """Return the names of fields that are neither coordinates nor carried."""
    return tuple(name for name in names if name not in ("x", "y", "z", *carried.names))


def _checked(path: Path, name: str, values: np.ndarray, depth: str) -> np.ndarray:
    most = np.iinfo(depth).max
    if not ((values >= 0) & (values <= most)).all():  # of a text file: NaN is refused, too
        raise DataError(f"{path}: a value of '{name}' is not within 0 to {most}; export it again")
    return values
