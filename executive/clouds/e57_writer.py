"""Point clouds as E57 files (ASTM E2807): one scan, whose frame is that of the file."""

import hashlib
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from executive.clouds.file_cloud import FileCloud, Place
from executive.errors import DataError
from executive.extras import require_extra

_AXES = "XYZ"
_COLOURS = ("colorRed", "colorGreen", "colorBlue")
_WKT = 2112  # record of LAS 1.4 R15 (ASPRS), Sec. 3


def write_e57(path: Path, cloud: FileCloud) -> tuple[str, ...]:
    """Write a cloud as E57 and return what is changed, which is nothing.

    Coordinates are in double precision, intensities in single precision as they are read, colours
    whole numbers of their own depth. The coordinate system is `coordinateMetadata`: the WKT of the
    LAS file that the cloud came from, else its name. Equal clouds give equal files.

    Raises:
        MissingExtraError: If the package that writes it is not installed.
        DataError: If an intensity is not finite, or the library cannot write the file.
    """
    require_extra(f"{path}: an E57 file", "e57")
    from pye57 import libe57

    if cloud.intensity is not None and not np.isfinite(cloud.intensity).all():
        raise DataError(
            f"{path}: an intensity is not finite, and E57 files state limits of theirs; write a "
            "PLY or PCD file"
        )
    columns = _columns(cloud)
    try:
        image = libe57.ImageFile(str(path), "w")
        try:
            _write(libe57, image, cloud, columns)
        except BaseException:  # such as Ctrl-C: what is begun is no file
            image.cancel()
            raise
        image.close()
    except libe57.E57Exception as error:
        said = " ".join(str(error).split())
        raise DataError(f"{path}: cannot be written ({said}); write a PLY or PCD file") from error
    return ()


def _columns(cloud: FileCloud) -> dict[str, np.ndarray]:
    """Return the numbers of each field, shape (N,) and contiguous, as the library takes them."""
    columns: dict[str, np.ndarray] = {
        f"cartesian{axis}": cloud.points[:, i] for i, axis in enumerate(_AXES)
    }
    if cloud.colour is not None:
        columns |= {name: cloud.colour[:, i] for i, name in enumerate(_COLOURS)}
    if cloud.intensity is not None:
        columns["intensity"] = cloud.intensity
    return {name: np.array(values, dtype=np.float64) for name, values in columns.items()}


def _write(libe57: Any, image: Any, cloud: FileCloud, columns: Mapping[str, np.ndarray]) -> None:
    content = hashlib.sha256(b"".join(values.tobytes() for values in columns.values()))
    root, guid = image.root(), uuid.uuid5(uuid.NAMESPACE_OID, content.hexdigest())
    image.extensionsAdd("", libe57.E57_V1_0_URI)
    for name, text in (
        ("formatName", "ASTM E57 3D Imaging Data File"),
        ("guid", f"{{{guid}}}"),
        ("e57LibraryVersion", libe57.E57_LIBRARY_ID),
        ("coordinateMetadata", _system(cloud.place)),
    ):
        root.set(name, libe57.StringNode(image, text))
    root.set("versionMajor", libe57.IntegerNode(image, libe57.E57_FORMAT_MAJOR))
    root.set("versionMinor", libe57.IntegerNode(image, libe57.E57_FORMAT_MINOR))
    data = libe57.VectorNode(image, True)
    root.set("data3D", data)
    scan = libe57.StructureNode(image)
    scan.set("guid", libe57.StringNode(image, f"{{{uuid.uuid5(guid, 'scan')}}}"))
    _set_limits(libe57, image, scan, cloud, columns)
    prototype = libe57.StructureNode(image)
    for name, values in columns.items():
        prototype.set(name, _kind(libe57, image, cloud, name, values))
    points = libe57.CompressedVectorNode(image, prototype, libe57.VectorNode(image, True))
    scan.set("points", points)
    data.append(scan)
    buffers = libe57.VectorSourceDestBuffer()
    for name, values in columns.items():  # converted to the field's own kind of number
        buffers.append(libe57.SourceDestBuffer(image, name, values, len(values), True, True))
    writer = points.writer(buffers)
    writer.write(len(cloud))
    writer.close()


def _system(place: Place) -> str:
    """Return the text of a coordinate system: WKT in one line if there is one, else its name."""
    wkt = dict(place.records).get(_WKT, b"").rstrip(b"\0").decode("utf-8", "replace")
    text = " ".join(wkt.split())
    return text if text and text.isprintable() else place.crs


def _most(cloud: FileCloud) -> int:
    """Return the largest number of a channel of the colour: 255, or 65535."""
    return 0 if cloud.colour is None else int(np.iinfo(cloud.colour.dtype).max)


def _set_limits(
    libe57: Any, image: Any, scan: Any, cloud: FileCloud, columns: Mapping[str, np.ndarray]
) -> None:
    """State the box of the points, and what colours and intensities lie between."""
    box = libe57.StructureNode(image)
    for axis in _AXES:
        for word, value in _ends(columns[f"cartesian{axis}"]):
            box.set(f"{axis.lower()}{word}", libe57.FloatNode(image, value))
    scan.set("cartesianBounds", box)
    if cloud.colour is not None:
        limits = libe57.StructureNode(image)
        for name in _COLOURS:
            limits.set(f"{name}Minimum", libe57.IntegerNode(image, 0))
            limits.set(f"{name}Maximum", libe57.IntegerNode(image, _most(cloud)))
        scan.set("colorLimits", limits)
    if cloud.intensity is not None:
        limits = libe57.StructureNode(image)
        for word, value in _ends(columns["intensity"]):
            limits.set(f"intensity{word}", libe57.FloatNode(image, value))
        scan.set("intensityLimits", limits)


def _ends(values: np.ndarray) -> tuple[tuple[str, float], tuple[str, float]]:
    return ("Minimum", float(values.min())), ("Maximum", float(values.max()))


def _kind(libe57: Any, image: Any, cloud: FileCloud, name: str, values: np.ndarray) -> Any:
    """Return the library's node of a kind of number."""
    if name in _COLOURS:
        return libe57.IntegerNode(image, 0, 0, _most(cloud))
    low, high = float(values.min()), float(values.max())
    precision = libe57.E57_SINGLE if name == "intensity" else libe57.E57_DOUBLE
    return libe57.FloatNode(image, low, precision, low, high)
