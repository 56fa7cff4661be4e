"""Recorded positions of a drone's pictures, from a table beside them or from their GPS tags."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu

TABLE = "positions.csv"
_LOCAL, _GEODETIC = ("x", "y", "z"), ("lat", "lon", "alt")
_ORIGIN_LOCAL = ("origin_x_m", "origin_y_m", "origin_z_m")
_ORIGIN_GEODETIC = ("origin_lat_deg", "origin_lon_deg", "origin_alt_m")
_GPS, _LATITUDE_REF, _LATITUDE, _LONGITUDE_REF, _LONGITUDE, _BELOW_SEA, _ALTITUDE = (
    0x8825,
    1,
    2,
    3,
    4,
    5,
    6,
)


@dataclass(frozen=True, slots=True, eq=False)
class RecordedPositions:
    """Where pictures were taken.

    Attributes:
        values_m: Rough position of each picture, z up, about their mean [m], shape (N, 3).
        origin: That mean: `origin_x_m`, `origin_y_m` and `origin_z_m` in a table's coordinates, or
            `origin_lat_deg`, `origin_lon_deg` and `origin_alt_m`.
    """

    values_m: Float
    origin: Mapping[str, float]


def positions_of(pictures: Sequence[Path], table: Path | None) -> Float:
    """Return the rough position of each picture [m], z up, about their mean, shape (N, 3).

    Args:
        pictures: Files.
        table: As of `recorded_positions`.

    Raises:
        DataError: As `recorded_positions`.
    """
    return recorded_positions(pictures, table).values_m


def recorded_positions(pictures: Sequence[Path], table: Path | None) -> RecordedPositions:
    """Return the rough position of each picture, and where their mean is.

    Args:
        pictures: Files.
        table: A CSV file with a header `name,x,y,z` [m] or `name,lat,lon,alt` [deg, deg, m];
            without one, the pictures' GPS tags.

    Raises:
        DataError: If the table cannot be read, or a picture has no position; the message names it
            and the cure.
    """
    found, datum = _from_table(table) if table else _from_pictures(pictures)
    missing = [path.name for path in pictures if path.name not in found]
    if missing:
        where = str(table) if table else f"no {TABLE} beside them, and no GPS tags in them"
        raise DataError(
            f"{pictures[0].parent}: {len(missing)} of {len(pictures)} pictures have no "
            f"position ({where}), such as "
            f"{missing[0]}; give each a line in {TABLE}, name,x,y,z in metres or "
            "name,lat,lon,alt, or take it out"
        )
    positions = np.array([found[path.name] for path in pictures])
    mean = positions.mean(axis=0)
    place = mean if datum is None else geodetic_from_enu(mean, datum)
    names = _ORIGIN_LOCAL if datum is None else _ORIGIN_GEODETIC
    return RecordedPositions(positions - mean, dict(zip(names, place.tolist(), strict=True)))


def _from_table(table: Path) -> tuple[Mapping[str, Float], Float | None]:
    """Return positions by name, geodetic ones about the first line's; and the first line's
    latitude, longitude [deg] and altitude [m], or None.
    """
    try:
        with table.open(newline="", encoding="utf-8-sig") as file:
            rows = [[cell.strip() for cell in row] for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DataError(f"{table}: cannot be read as a table: {error}") from error
    header = tuple(cell.lower() for cell in rows[0]) if rows else ()
    if header not in (("name", *_LOCAL), ("name", *_GEODETIC)):
        raise DataError(
            f"{table}:1: the first line is {','.join(header)!r}; wanted is name,x,y,z "
            "or name,lat,lon,alt"
        )
    values = {row[0]: _numbers(table, i, row) for i, row in enumerate(rows[1:], 2)}
    if header[1:] == _GEODETIC:
        return _enu(values, str(table))
    return values, None


def _numbers(table: Path, line: int, row: Sequence[str]) -> Float:
    try:
        values = np.array([float(cell) for cell in row[1:]])
    except ValueError:
        values = np.empty(0)
    if values.shape != (3,) or not np.isfinite(values).all():
        raise DataError(f"{table}:{line}: {','.join(row)!r} is no name and three numbers")
    return values


def _from_pictures(pictures: Sequence[Path]) -> tuple[Mapping[str, Float], Float]:
    tagged = {path.name: _from_tags(path) for path in pictures}
    return _enu({name: tags for name, tags in tagged.items() if tags is not None}, "GPS tags")


def _from_tags(path: Path) -> Float | None:
    """Return latitude, longitude [deg] and altitude [m] of a picture's tags;
    None if there is none.
    """
    with Image.open(path) as picture:
        tags = picture.getexif().get_ifd(_GPS)
    if not {_LATITUDE, _LONGITUDE, _ALTITUDE} <= tags.keys():
        return None
    position = np.array(
        [
            _degrees(tags[_LATITUDE]) * (-1 if tags.get(_LATITUDE_REF) == "S" else 1),
            _degrees(tags[_LONGITUDE]) * (-1 if tags.get(_LONGITUDE_REF) == "W" else 1),
            float(tags[_ALTITUDE]) * (-1 if tags.get(_BELOW_SEA) == b"\x01" else 1),
        ]
    )
    return position if np.isfinite(position).all() else None  # 0/0: a receiver without a fix


def _degrees(parts: Any) -> float:
    """Return degrees of degrees, minutes and seconds."""
    return float(sum(float(part) / 60**i for i, part in enumerate(parts)))


def _enu(geodetic: Mapping[str, Float], where: str) -> tuple[Mapping[str, Float], Float]:
    for name, (latitude, longitude, _) in geodetic.items():
        if not (-90 <= latitude <= 90 and -180 <= longitude <= 180):
            raise DataError(
                f"{where}: {name}: {latitude:g}, {longitude:g} is no latitude and "
                "longitude in degrees"
            )
    datum = next(iter(geodetic.values()), np.zeros(3))
    found = {name: enu_from_geodetic(position, datum) for name, position in geodetic.items()}
    return found, datum
