"""Points of LAS files, read in this process: units, boxes, and headers that promise too much."""

import struct
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from executive.errors import DataError

OFFSET = np.array([412_000.0, 5_246_000.0, 440.0])
POINTS = np.round(np.random.default_rng(0).uniform(0, 10, (200, 3)), 3) + OFFSET


@pytest.fixture
def parts() -> Iterator[Any]:
    """The module, imported here; it hides a package that other tests may want."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "requests", None)
        from executive.clouds import las_points

        yield las_points


@pytest.fixture
def las(parts: Any, tmp_path: Path) -> Callable[..., Path]:
    """Return what writes a file with GeoTIFF keys, or a well-known text."""
    laspy = parts.laspy

    def write(name: str = "site.las", key: tuple[int, int] | None = None, wkt: str = "") -> Path:
        header = laspy.LasHeader(point_format=3, version="1.2")
        header.scales, header.offsets = np.full(3, 0.001), OFFSET
        data = laspy.LasData(header)
        data.xyz = POINTS
        if key:
            record = struct.pack("<8H", 1, 1, 0, 1, key[0], 0, 1, key[1])
            data.header.vlrs.append(laspy.VLR("LASF_Projection", 34735, record_data=record))
        if wkt:
            told = laspy.VLR("LASF_Projection", 2112, record_data=wkt.encode() + b"\0")
            data.header.vlrs.append(told)
        data.write(tmp_path / name)
        return tmp_path / name

    return write


@pytest.mark.parametrize("name", ["site.las", "site.laz"])
def test_the_points_are_read_to_the_millimetre(parts: Any, las: Any, name: str) -> None:
    (points,) = parts.las_points(las(name))
    np.testing.assert_allclose(points, POINTS, atol=1e-6, rtol=0)


@pytest.mark.parametrize(
    ("key", "wkt", "unit"),
    [
        ((3076, 9002), "", "feet"),
        ((3076, 9003), "", "US survey feet"),
        ((3076, 9036), "", "the unit EPSG:9036"),
        ((1024, 2), "", "degrees"),
        (None, 'GEOGCS["WGS 84"]', "degrees"),
        (None, 'PROJCS["x",UNIT["US survey foot",0.3048006]]', "feet"),
        (None, 'PROJCS["x",UNIT["Feet",0.3048]]', "feet"),
    ],
)
def test_a_unit_that_is_not_the_metre_is_refused(
    parts: Any, las: Any, key: Any, wkt: str, unit: str
) -> None:
    with pytest.raises(DataError, match=rf"coordinates are in {unit}; project it to metres"):
        parts.las_points(las(key=key, wkt=wkt))


@pytest.mark.parametrize(
    ("key", "wkt"), [((3076, 9001), ""), ((1024, 1), ""), (None, 'PROJCS["x",UNIT["metre",1]]')]
)
def test_the_metre_may_be_named(parts: Any, las: Any, key: Any, wkt: str) -> None:
    assert len(parts.las_points(las(key=key, wkt=wkt))[0]) == 200


def test_damage_is_told_with_the_file(parts: Any, las: Any) -> None:
    path = las()
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(DataError, match=r"site\.las: cut short or damaged \(.*\); copy or export"):
        parts.las_points(path)


def header(**other: Any) -> SimpleNamespace:
    told = {
        "scales": np.full(3, 0.001),
        "offsets": np.zeros(3),
        "offset_to_point_data": 100,
        "point_count": 10,
        "point_format": SimpleNamespace(size=20),
        "are_points_compressed": False,
        "vlrs": SimpleNamespace(get=lambda name: []),
        "mins": np.zeros(3),
        "maxs": np.array([10.0, 4.0, 2.0]),
    }
    return SimpleNamespace(**{**told, **other})


@pytest.mark.parametrize(
    "wrong",
    [
        {"scales": np.array([0.001, 0.0, 0.001])},
        {"scales": np.array([0.001, -0.001, 0.001])},
        {"scales": np.array([0.001, np.inf, 0.001])},
        {"offsets": np.array([0.0, 0.0, np.nan])},
    ],
)
def test_a_scale_or_an_offset_that_is_none_is_refused(parts: Any, tmp_path: Path, wrong) -> None:
    with pytest.raises(DataError, match=r"the scale .* in its header is invalid"):
        parts._check_header(tmp_path / "a.las", header(**wrong))


def test_a_file_has_the_bytes_that_its_header_promises(parts: Any, tmp_path: Path) -> None:
    path = tmp_path / "a.las"
    path.write_bytes(bytes(300))
    parts._check_header(path, header())
    path.write_bytes(bytes(299))
    with pytest.raises(DataError, match=r"promises 10 points \(300 bytes\), the file has 299"):
        parts._check_header(path, header())
    parts._check_header(path, header(are_points_compressed=True))


@pytest.mark.parametrize(
    ("point", "is_within"),
    [
        ((10.10, 1.0, 1.0), True),  # 1 % of 10 m, and two steps of a millimetre
        ((10.11, 1.0, 1.0), False),
        ((-0.10, 1.0, 1.0), True),
        ((-0.11, 1.0, 1.0), False),
        ((1.0, 1.0, 2.102), True),
        ((1.0, 1.0, 2.103), False),
        ((1.0, 1.0, -0.103), False),
    ],
)
def test_points_may_lie_a_hundredth_outside_the_box(
    parts: Any, tmp_path: Path, point: Any, is_within: bool
) -> None:
    points = np.array([[1.0, 1.0, 1.0], point])
    if is_within:
        parts._check_box(tmp_path / "a.las", header(), points)
    else:
        with pytest.raises(DataError, match="has points outside the bounding box"):
            parts._check_box(tmp_path / "a.las", header(), points)
    none = header(mins=np.zeros(3), maxs=np.zeros(3))
    parts._check_box(tmp_path / "a.las", none, points)  # some programs write no box
    flat = header(maxs=np.array([10.0, 0.0, 0.0]))
    with pytest.raises(DataError, match="bounding box"):
        parts._check_box(tmp_path / "a.las", flat, points)
