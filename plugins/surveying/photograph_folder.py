"""A folder of a drone's pictures, with rough positions."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from executive_plugins.surveying.camera_positions import TABLE, recorded_positions
from PIL import Image, UnidentifiedImageError

from executive.arrays import Float, checked
from executive.errors import DataError

_SUFFIXES = (".jpg", ".jpeg", ".png")


@dataclass(frozen=True, slots=True, eq=False)
class Photographs:
    """Pictures of one camera.

    Attributes:
        folder: Where they are.
        names: Of the files, sorted.
        positions_m: Where the drone says they were taken, z up, about their mean [m], shape (N, 3).
        size_px: Width and height.
        origin: Where their mean is, as of `RecordedPositions`; empty if nobody knows.
    """

    folder: Path
    names: tuple[str, ...]
    positions_m: Float
    size_px: tuple[int, int]
    origin: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "positions_m", checked("positions_m", self.positions_m, len(self.names), 3)
        )


def read_photographs(folder: Path, positions: Path | None, fewest: int) -> Photographs:
    """List the JPEG and PNG files of a folder; of the pictures themselves only the headers are
    read.

    Args:
        folder: Where they are.
        positions: Table of rough positions; `positions.csv` in the folder if there is one, else the
            GPS tags.
        fewest: Fewer pictures are no survey.

    Raises:
        DataError: If there are too few, of several sizes, unreadable, or without positions; with
            the cure.
    """
    if not folder.is_dir():
        raise DataError(f"{folder}: no such folder; give one that holds a drone's pictures")
    pictures = sorted(path for path in folder.iterdir() if path.suffix.lower() in _SUFFIXES)
    if len(pictures) < fewest:
        raise DataError(
            f"{folder}: {len(pictures)} pictures (JPEG or PNG), a survey needs at least "
            f"{fewest} that overlap; "
            "fly a grid whose pictures show 70 % of what their neighbours show"
        )
    table = positions or (folder / TABLE if (folder / TABLE).is_file() else None)
    size_px = _size_px(pictures)
    recorded = recorded_positions(pictures, table)
    names = tuple(path.name for path in pictures)
    return Photographs(folder, names, recorded.values_m, size_px, recorded.origin)


def _size_px(pictures: list[Path]) -> tuple[int, int]:
    sizes: dict[tuple[int, int], str] = {}
    for path in pictures:
        try:
            with Image.open(path) as picture:
                sizes.setdefault(picture.size, path.name)
        except (OSError, UnidentifiedImageError) as error:
            raise DataError(
                f"{path}: no readable picture ({error}); copy it again, or take it out"
            ) from error
    if len(sizes) > 1:
        found = ", ".join(f"{name} {width}×{height}" for (width, height), name in sizes.items())
        raise DataError(
            f"{pictures[0].parent}: pictures of several sizes ({found}); keep those of one camera"
        )
    return next(iter(sizes))
