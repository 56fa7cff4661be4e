"""Points from PCD files: text, binary and compressed."""

from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.clouds.binary_rows import collect_rows
from executive.clouds.pcd_header import PcdHeader, read_pcd_header
from executive.clouds.point_collector import CHUNK, PointCollector
from executive.clouds.text_rows import collect_lines
from executive.errors import DataError

_MOST_PACKED = 90  # upper bound of the compression ratio: a byte of LZF unpacks to at most 88


def read_pcd(path: Path) -> Float:
    """Return the points of a PCD file [m], shape (N, 3).

    The viewpoint in the header is not applied.

    Raises:
        DataError: If it is cut short, or its header or a line cannot be parsed.
    """
    header = read_pcd_header(path)
    size = path.stat().st_size - header.start
    if header.form == "binary_compressed":
        return _read_compressed(path, header, size)
    least = header.count * (
        2 * header.columns_of_a_line if header.form == "ascii" else header.row.itemsize
    )
    if size < least - (header.form == "ascii"):
        raise _cut_short(path, header, f"at least {least} bytes", f"{size} bytes")
    collector = PointCollector(path, header.count)
    if header.form == "binary":
        collect_rows(path, header.start, header.row, header.count, collector)
    else:
        found = collect_lines(
            path, header.start, header.lines + 1, header.columns, header.count, collector
        )
        if found < header.count:
            raise _cut_short(path, header, "a line each", f"{found} lines")
    return collector.points()


def _read_compressed(path: Path, header: PcdHeader, size: int) -> Float:
    """Return the points of a compressed file, which stores all x, then all y, and so on."""
    from executive.clouds.lzf import decompress  # imports numba: only compressed files need it

    with path.open("rb") as file:
        file.seek(header.start)
        lengths = np.frombuffer(file.read(8).ljust(8, b"\0"), dtype="<u4")
        packed = np.frombuffer(file.read(), dtype=np.uint8)
    wanted = header.count * header.row.itemsize
    if len(packed) < lengths[0]:
        raise _cut_short(path, header, f"{lengths[0]} packed bytes", f"{max(0, size - 8)} bytes")
    if lengths[1] < wanted or wanted > _MOST_PACKED * len(packed):
        raise DataError(
            f"{path}: {header.count} points cannot be in {len(packed)} packed bytes; "
            "export it again"
        )
    collector = PointCollector(path, header.count)
    starts = (
        {name: header.count * header.row.fields[name][1] for name in "xyz"}
        if header.row.fields
        else {}
    )
    ends = [starts[name] + header.count * header.row[name].itemsize for name in "xyz"]
    unpacked = decompress(packed[: lengths[0]], max(ends))
    if len(unpacked) < max(ends):
        raise DataError(f"{path}: its compressed points are damaged; copy or export it again")
    columns = [
        unpacked[starts[name] : end].view(header.row[name])
        for name, end in zip("xyz", ends, strict=True)
    ]
    for begun in range(0, header.count, CHUNK):
        x, y, z = (column[begun : begun + CHUNK] for column in columns)
        collector.add(x, y, z)
    return collector.points()


def _cut_short(path: Path, header: PcdHeader, wanted: str, found: str) -> DataError:
    return DataError(
        f"{path}: cut short: the header promises {header.count} points ({wanted}), the "
        f"file has {found}; copy or export it again"
    )
