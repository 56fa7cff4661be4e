"""E57 files as terrestrial scanners write them: scans with poses, colours, and whole steps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from pye57 import libe57

COLOURS = ("colorRed", "colorGreen", "colorBlue")
_INVALID = ("cartesianInvalidState", "sphericalInvalidState")
_STEP = 1e-4  # of coordinates in whole steps


@dataclass(frozen=True)
class Scan:
    """One scan.

    Attributes:
        fields: Numbers of its points by the field's name, shape (N,) each.
        q_wxyz: Rotation of its pose; None leaves the pose out.
        t: Translation of its pose.
        most: Largest number of a channel of its colour.
    """

    fields: Mapping[str, np.ndarray]
    q_wxyz: Sequence[float] | None = None
    t: Sequence[float] = field(default=(0.0, 0.0, 0.0))
    most: int = 255


def write_e57(path: Path, scans: Sequence[Scan], crs: str = "", in_steps: bool = False) -> Path:
    """Write scans into a file; coordinates are doubles, or whole numbers of 0.1 mm."""
    image = libe57.ImageFile(str(path), "w")
    root = image.root()
    image.extensionsAdd("", libe57.E57_V1_0_URI)
    root.set("formatName", libe57.StringNode(image, "ASTM E57 3D Imaging Data File"))
    root.set("guid", libe57.StringNode(image, "{1}"))
    root.set("versionMajor", libe57.IntegerNode(image, 1))
    root.set("versionMinor", libe57.IntegerNode(image, 0))
    root.set("coordinateMetadata", libe57.StringNode(image, crs))
    data = libe57.VectorNode(image, True)
    root.set("data3D", data)
    for scan in scans:
        _write_scan(image, data, scan, in_steps)
    image.close()
    return path


def _write_scan(image, data, scan: Scan, in_steps: bool) -> None:
    node = libe57.StructureNode(image)
    node.set("guid", libe57.StringNode(image, "{2}"))
    if scan.q_wxyz is not None:
        pose = libe57.StructureNode(image)
        node.set("pose", pose)
        pose.set("rotation", _numbers(image, "wxyz", scan.q_wxyz))
        pose.set("translation", _numbers(image, "xyz", scan.t))
    if COLOURS[0] in scan.fields:
        limits = libe57.StructureNode(image)
        for name in COLOURS:
            limits.set(f"{name}Maximum", libe57.IntegerNode(image, scan.most))
        node.set("colorLimits", limits)
    prototype = libe57.StructureNode(image)
    for name in scan.fields:
        prototype.set(name, _kind(image, name, scan.most, in_steps))
    codecs = libe57.VectorNode(image, True)
    points = libe57.CompressedVectorNode(image, prototype, codecs)
    node.set("points", points)
    data.append(node)
    columns = {name: np.array(values, dtype=float) for name, values in scan.fields.items()}
    buffers = libe57.VectorSourceDestBuffer()
    for name, column in columns.items():
        buffers.append(libe57.SourceDestBuffer(image, name, column, len(column), True, True))
    writer = points.writer(buffers)
    writer.write(len(next(iter(columns.values()))))
    writer.close()


def _numbers(image, names: str, values: Sequence[float]):
    node = libe57.StructureNode(image)
    for name, value in zip(names, values, strict=True):
        node.set(name, libe57.FloatNode(image, float(value)))
    return node


def _kind(image, name: str, most: int, in_steps: bool):
    if name in COLOURS:
        return libe57.IntegerNode(image, 0, 0, most)
    if name in _INVALID:
        return libe57.IntegerNode(image, 0, 0, 2)
    if in_steps and name.startswith("cartesian"):
        return libe57.ScaledIntegerNode(image, 0, -(2**31), 2**31 - 1, _STEP, 0.0)
    return libe57.FloatNode(image, 0.0)


def mended(content: bytes) -> bytes:
    """Return a file whose pages have the checksums that they should have (CRC-32C)."""
    pages = [content[at : at + 1024] for at in range(0, len(content), 1024)]
    return b"".join(
        page[:1020] + _checksum(page[:1020]) if len(page) == 1024 else page for page in pages
    )


def _checksum(content: bytes) -> bytes:
    rest = 0xFFFFFFFF
    for byte in content:
        rest = _TABLE[(rest ^ byte) & 0xFF] ^ (rest >> 8)
    return (rest ^ 0xFFFFFFFF).to_bytes(4, "big")


def _entry(number: int) -> int:
    for _ in range(8):
        number = (number >> 1) ^ (0x82F63B78 if number & 1 else 0)
    return number


_TABLE = [_entry(number) for number in range(256)]
