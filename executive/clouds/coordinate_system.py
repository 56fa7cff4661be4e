"""The coordinate system that a cloud's file names, kept for what is computed from the cloud."""

import re
import struct
from pathlib import Path

from executive.clouds.e57 import e57_crs
from executive.clouds.e57_header import MAGIC
from executive.clouds.las_header import projection_records
from executive.errors import DataError

_MOST_HEADER = 1 << 16  # bytes of a PLY header
_MOST_NAME = 1 << 14  # characters: a PLY header has to hold it; those of national grids have 2,000
_PLY_LINE = re.compile(rb"^comment crs (.+?)\s*$", re.MULTILINE)
_PCD_LINE = re.compile(rb"^# crs (.+?)\s*$", re.MULTILINE)
_CODE = re.compile(r'(?:AUTHORITY\["EPSG","(\d+)"\]|ID\["EPSG",(\d+)\])\s*\]\s*$')
_WKT, _GEO_KEYS = 2112, 34735  # records of LAS 1.4 R15 (ASPRS), Sec. 3
_PROJECTED, _OWN = 3072, 32767  # GeoTIFF: ProjectedCSTypeGeoKey; user-defined


def coordinate_system(path: Path) -> str:
    """Return the name of a file's coordinate system: `EPSG:code`, else WKT; empty if it has none.

    LAS and LAZ files name it in a record, E57 files in their text, and PLY and PCD files that were
    written here in a comment.
    The file is one that was read before: its header is sound.

    Raises:
        DataError: If the name is longer than any.
    """
    with path.open("rb") as file:
        beginning = file.read(_MOST_HEADER)
    if beginning.startswith(b"ply"):
        named = _PLY_LINE.search(beginning.partition(b"end_header")[0])
        return named[1].decode("ascii", "replace") if named else ""
    if beginning.startswith(b"# .PCD"):
        named = _PCD_LINE.search(beginning.partition(b"\nDATA ")[0])
        return named[1].decode("ascii", "replace") if named else ""
    if beginning.startswith(MAGIC):
        return _named(path, e57_crs(path))
    if not beginning.startswith(b"LASF"):
        return ""
    found = dict(projection_records(path))
    if wkt := found.get(_WKT, b"").rstrip(b"\0").decode("utf-8", "replace").strip():
        return _named(path, wkt)
    return _epsg(found.get(_GEO_KEYS, b""))


def _named(path: Path, wkt: str) -> str:
    """Return the code with which the text ends, else the text in one line of ASCII."""
    code = _CODE.search(wkt)
    if code:
        return f"EPSG:{code[1] or code[2]}"
    name = " ".join(wkt.split()).encode("ascii", "backslashreplace").decode("ascii")
    return checked_name(path, name)


def checked_name(path: Path, name: str) -> str:
    """Return the name of a coordinate system that a file can hold as a comment.

    Raises:
        DataError: If it is longer than any, or no line of ASCII.
    """
    if len(name) > _MOST_NAME:
        raise DataError(
            f"{path}: its coordinate system has a name of {len(name)} characters, at most "
            f"{_MOST_NAME} are read; export it again"
        )
    if not (name.isascii() and name.isprintable() and name == name.strip()):
        raise DataError(f"{path}: a coordinate system is named by a line of ASCII, not {name!r}")
    return name


def _epsg(keys: bytes) -> str:
    """Return the code of the projected system in a GeoTIFF directory, rows of four integers."""
    rows = struct.iter_unpack("<4H", keys[8 : len(keys) // 8 * 8])
    codes = [value for key, place, _, value in rows if key == _PROJECTED and place == 0]
    return f"EPSG:{codes[0]}" if codes and codes[0] not in (0, _OWN) else ""
