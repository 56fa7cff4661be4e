"""The coordinate system of a cloud is read from its file and stays with what is written."""

import struct
from pathlib import Path

import laspy
import numpy as np
import pytest

from executive.clouds.coordinate_system import coordinate_system
from executive.clouds.ply_writer import write_parts, write_ply
from executive.errors import DataError

POINTS = np.random.default_rng(0).uniform(0, 10, (50, 3)) + [2_600_000.0, 1_200_000.0, 440.0]
LV95 = 'PROJCS["CH1903+ / LV95",GEOGCS["CH1903+"],AUTHORITY["EPSG","2056"]]'
OWN = 'PROJCS["Baustelle Zürich",\n GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]],UNIT["metre",1]]'


def las(path: Path, number: int, content: bytes, is_last: bool = False) -> Path:
    """Write a file with one record of its coordinate system, before or behind the points."""
    version, form = ("1.4", 6) if is_last else ("1.2", 3)
    header = laspy.LasHeader(point_format=form, version=version)
    header.scales, header.offsets = np.full(3, 0.001), POINTS.min(axis=0)
    data = laspy.LasData(header)
    data.xyz = POINTS
    record = laspy.VLR("LASF_Projection", number, record_data=content)
    if is_last:
        data.evlrs = laspy.vlrs.vlrlist.VLRList([record])
    else:
        data.header.vlrs.append(record)
    data.write(path)
    return path


def keys(*pairs: tuple[int, int]) -> bytes:
    rows = [(1, 1, 0, len(pairs)), *((key, 0, 1, value) for key, value in pairs)]
    return b"".join(struct.pack("<4H", *row) for row in rows)


@pytest.mark.parametrize("suffix", ["las", "laz"])
@pytest.mark.parametrize("is_last", [False, True])
def test_a_text_that_ends_with_a_code_is_told_by_it(
    tmp_path: Path, suffix: str, is_last: bool
) -> None:
    path = las(tmp_path / f"site.{suffix}", 2112, LV95.encode() + b"\0", is_last)
    assert coordinate_system(path) == "EPSG:2056"


def test_a_text_without_a_code_of_its_own_is_kept_in_one_line(tmp_path: Path) -> None:
    name = coordinate_system(las(tmp_path / "site.las", 2112, OWN.encode()))
    assert name.startswith('PROJCS["Baustelle Z\\xfcrich", GEOGCS["WGS 84"')
    write_parts(tmp_path / "parts.ply", [POINTS], name)
    assert coordinate_system(tmp_path / "parts.ply") == name


@pytest.mark.parametrize(
    ("pairs", "expected"),
    [
        (((1024, 1), (3072, 2056)), "EPSG:2056"),
        (((1024, 1), (3072, 32767)), ""),
        (((1024, 1),), ""),
    ],
    ids=["a code", "a system of its own", "none"],
)
def test_geotiff_keys_name_a_code(
    tmp_path: Path, pairs: tuple[tuple[int, int], ...], expected: str
) -> None:
    assert coordinate_system(las(tmp_path / "site.las", 34735, keys(*pairs))) == expected


def test_files_without_a_name_have_none(tmp_path: Path) -> None:
    write_ply(tmp_path / "cloud.ply", POINTS, "map")
    (tmp_path / "cloud.xyz").write_text("1 2 3\n")
    assert coordinate_system(tmp_path / "cloud.ply") == ""
    assert coordinate_system(tmp_path / "cloud.xyz") == ""


def test_a_name_longer_than_any_is_refused(tmp_path: Path) -> None:
    path = las(tmp_path / "site.las", 2112, b"LOCAL_CS[" + b"x" * 20_000 + b"]")
    with pytest.raises(DataError, match="a name of 20010 characters"):
        coordinate_system(path)
