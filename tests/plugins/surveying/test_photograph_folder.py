"""A folder of pictures: positions from a table or from tags,
and clear words for what is missing.
"""

from pathlib import Path

import numpy as np
import pytest
from executive_plugins.surveying.photograph_folder import Photographs, read_photographs
from PIL import Image

from executive.errors import DataError
from executive.geometry.geodesy import geodetic_from_enu

ENU = np.array([[0.0, 0, 10], [5, 0, 11], [0, 8, 10], [5, 8, 9], [2, 3, 10], [-4, 2, 10.5]])
NAMES = [f"flight 1 {i}.jpg" for i in range(6)]


def shoot(
    folder: Path, tags: list[Image.Exif] | None = None, size: tuple[int, int] = (40, 30)
) -> None:
    for i, name in enumerate(NAMES):
        Image.new("RGB", size, (i, i, i)).save(folder / name, exif=tags[i] if tags else b"")


def table(folder: Path, header: str, rows: np.ndarray) -> None:
    lines = [
        f"{name}, {', '.join(f'{x:.9f}' for x in row)}"
        for name, row in zip(NAMES, rows, strict=True)
    ]
    (folder / "positions.csv").write_text("\n".join([header, *lines, ""]))


def geodetic(datum: np.ndarray) -> np.ndarray:
    return np.array([geodetic_from_enu(p, datum) for p in ENU])


def gps(latitude: float, longitude: float, altitude: float) -> Image.Exif:
    """Return tags as cameras write them: degrees, minutes and seconds,
    and hemispheres as letters.
    """

    def parts(angle: float) -> tuple[float, float, float]:
        minutes = (abs(angle) - int(abs(angle))) * 60
        return float(int(abs(angle))), float(int(minutes)), (minutes - int(minutes)) * 60

    tags = Image.Exif()
    ifd = tags.get_ifd(0x8825)
    ifd[1], ifd[2] = "NS"[latitude < 0], parts(latitude)
    ifd[3], ifd[4] = "EW"[longitude < 0], parts(longitude)
    ifd[5], ifd[6] = bytes([altitude < 0]), abs(altitude)
    return tags


def shape(photographs: Photographs) -> np.ndarray:
    """Return all distances between positions: what no choice of origin or heading changes."""
    p = photographs.positions_m
    return np.linalg.norm(p[:, None] - p, axis=2)


DISTANCES = np.linalg.norm(ENU[:, None] - ENU, axis=2)


def test_reads_local_positions_from_a_table(tmp_path: Path) -> None:
    shoot(tmp_path)
    table(tmp_path, "name, x, y, z", ENU)
    found = read_photographs(tmp_path, None, 6)
    assert found.names == tuple(NAMES)
    assert found.size_px == (40, 30)
    assert np.allclose(found.positions_m, ENU - ENU.mean(axis=0))


@pytest.mark.parametrize("datum", [[47.4, 8.5, 440], [-33.9, -70.6, 520], [31.5, 35.4, -400]])
def test_reads_geodetic_positions_from_a_table_and_from_tags_alike(
    tmp_path: Path, datum: list[float]
) -> None:
    rows = geodetic(np.array(datum))
    shoot(tmp_path, [gps(*row.tolist()) for row in rows])
    from_tags = read_photographs(tmp_path, None, 6)
    table(tmp_path, "name,lat,lon,alt", rows)
    from_table = read_photographs(tmp_path, None, 6)
    # Tags hold seconds as fractions of integers, good to some centimetres.
    assert np.allclose(shape(from_tags), DISTANCES, atol=0.05)
    assert np.allclose(shape(from_table), DISTANCES, atol=1e-3)
    assert np.allclose(from_table.positions_m, ENU - ENU.mean(axis=0), atol=1e-3)


def test_prefers_the_table_that_is_named(tmp_path: Path) -> None:
    shoot(tmp_path)
    table(tmp_path, "name,x,y,z", 2 * ENU)
    own = tmp_path / "own.csv"
    (tmp_path / "positions.csv").rename(own)
    assert np.allclose(shape(read_photographs(tmp_path, own, 6)), 2 * DISTANCES)


def test_names_a_folder_that_is_missing_or_nearly_empty(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="no such folder"):
        read_photographs(tmp_path / "none", None, 6)
    with pytest.raises(DataError, match=r"0 pictures \(JPEG or PNG\), a survey needs at least 6"):
        read_photographs(tmp_path, None, 6)
    shoot(tmp_path)
    with pytest.raises(DataError, match=r"6 pictures .* needs at least 7"):
        read_photographs(tmp_path, None, 7)


def test_names_pictures_without_a_position(tmp_path: Path) -> None:
    shoot(tmp_path)
    with pytest.raises(
        DataError, match=r"6 of 6 pictures have no position \(no positions.csv .*flight 1 0.jpg"
    ):
        read_photographs(tmp_path, None, 6)
    table(tmp_path, "name,x,y,z", ENU)
    text = (tmp_path / "positions.csv").read_text().splitlines()
    (tmp_path / "positions.csv").write_text("\n".join(line for line in text if "1 3" not in line))
    with pytest.raises(DataError, match=r"1 of 6 pictures have no position .*flight 1 3.jpg"):
        read_photographs(tmp_path, None, 6)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", r"positions.csv:1: the first line is ''; wanted is name,x,y,z or name,lat,lon,alt"),
        ("file,x,y,z\n", "positions.csv:1: the first line is 'file,x,y,z'"),
        ("name,x,y,z\na.jpg,1,2\n", "positions.csv:2: 'a.jpg,1,2' is no name and three numbers"),
        ("name,x,y,z\na.jpg,1,2,3\nb.jpg,1,two,3\n", "positions.csv:3: 'b.jpg,1,two,3'"),
        ("name,x,y,z\na.jpg,1,nan,3\n", "positions.csv:2"),
        (
            "name,lat,lon,alt\na.jpg,2683000,1247000,440\n",
            "a.jpg: 2.683e.06, 1.247e.06 is no latitude and longitude",
        ),
    ],
)
def test_names_the_line_of_a_table_that_is_wrong(tmp_path: Path, text: str, words: str) -> None:
    shoot(tmp_path)
    (tmp_path / "positions.csv").write_text(text)
    with pytest.raises(DataError, match=words):
        read_photographs(tmp_path, None, 6)


def test_names_a_picture_that_cannot_be_read_and_pictures_of_several_cameras(
    tmp_path: Path,
) -> None:
    shoot(tmp_path)
    table(tmp_path, "name,x,y,z", ENU)
    Image.new("RGB", (50, 30)).save(tmp_path / NAMES[2])
    with pytest.raises(
        DataError, match=r"several sizes \(flight 1 0.jpg 40×30, flight 1 2.jpg 50×30\)"
    ):
        read_photographs(tmp_path, None, 6)
    (tmp_path / NAMES[2]).write_bytes(b"no picture")
    with pytest.raises(DataError, match=r"flight 1 2.jpg: no readable picture"):
        read_photographs(tmp_path, None, 6)
