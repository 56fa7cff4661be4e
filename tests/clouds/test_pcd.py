"""PCD files read and written in this process: each form, what is carried, and files cut short."""

from pathlib import Path

import numpy as np
import pytest

from executive.clouds.file_cloud import FileCloud, Place
from executive.clouds.pcd import read_pcd, read_pcd_cloud
from executive.clouds.pcd_writer import write_pcd
from executive.errors import DataError

COUNT = 40
RNG = np.random.default_rng(3)
POINTS = RNG.integers(-400, 400, (COUNT, 3)) / 16.0
COLOUR = RNG.integers(0, 256, (COUNT, 3)).astype(np.uint8)
STRENGTH = RNG.integers(0, 100, COUNT).astype(np.float32)
NAMES = "x y z rgb intensity ring"
ROW = np.dtype(
    [(n, "<f4") for n in "xyz"] + [("rgb", "<u4"), ("intensity", "<f4"), ("ring", "<u2")]
)


def rows() -> np.ndarray:
    made = np.zeros(COUNT, ROW)
    made["x"], made["y"], made["z"] = POINTS.T
    made["rgb"] = COLOUR.astype(np.uint32) @ np.array([65536, 256, 1], np.uint32)
    made["intensity"], made["ring"] = STRENGTH, np.arange(COUNT)
    return made


def header(form: str) -> bytes:
    words = ["# .PCD v0.7", "VERSION 0.7", f"FIELDS {NAMES}", "SIZE 4 4 4 4 4 2"]
    words += ["TYPE F F F U F U", "COUNT 1 1 1 1 1 1", f"WIDTH {COUNT}", "HEIGHT 1"]
    return "\n".join([*words, f"POINTS {COUNT}", f"DATA {form}", ""]).encode()


def packed(content: bytes) -> bytes:
    """Pack bytes by LZF: runs of zeros as references to the byte before, all else as it is."""
    out, at = bytearray(), 0
    while at < len(content):
        same = 0
        while at and same < 200 and content[at + same : at + same + 1] == content[at - 1 : at]:
            same += 1
        if same >= 3:
            least = min(same - 2, 7)
            out += bytes([least << 5]) + (bytes([same - 9]) if least == 7 else b"") + b"\0"
            at += same
        else:
            out += b"\0" + content[at : at + 1]
            at += 1
    return bytes(out)


def compressed() -> bytes:
    columns = b"".join(np.ascontiguousarray(rows()[name]).tobytes() for name in ROW.names or ())
    short = packed(columns)
    lengths = np.array([len(short), len(columns)], "<u4").tobytes()
    return header("binary_compressed") + lengths + short


def lines() -> bytes:
    return "".join(" ".join(str(value) for value in row) + "\n" for row in rows()).encode()


FORMS = {
    "ascii": header("ascii") + lines(),
    "binary": header("binary") + rows().tobytes(),
    "binary_compressed": compressed(),
}


@pytest.mark.parametrize("form", FORMS)
def test_each_form_gives_the_same_points_with_colour_and_intensity(
    tmp_path: Path, form: str
) -> None:
    path = tmp_path / "one.pcd"
    path.write_bytes(FORMS[form])
    assert np.array_equal(read_pcd(path), POINTS)
    cloud = read_pcd_cloud(path)
    assert np.array_equal(cloud.points, POINTS)
    assert np.array_equal(cloud.colour, COLOUR)
    assert np.array_equal(cloud.intensity, STRENGTH)
    assert cloud.left_out == ("ring",)


@pytest.mark.parametrize(
    ("form", "told"),
    [
        ("ascii", "a line each"),
        ("binary", f"at least {COUNT * ROW.itemsize} bytes"),
        ("binary_compressed", "packed bytes"),
    ],
)
def test_a_file_that_lacks_its_end_is_refused_with_what_was_promised(
    tmp_path: Path, form: str, told: str
) -> None:
    path = tmp_path / "cut.pcd"
    cut = -len(lines().splitlines(keepends=True)[-1]) if form == "ascii" else -1
    path.write_bytes(FORMS[form][:cut])
    with pytest.raises(DataError, match=f"cut short: the header promises {COUNT} points") as error:
        read_pcd(path)
    assert told in str(error.value)
    assert str(error.value).endswith("copy or export it again")


def test_a_last_line_without_its_end_is_read(tmp_path: Path) -> None:
    path = tmp_path / "one.pcd"
    path.write_bytes(FORMS["ascii"][:-1])
    assert np.array_equal(read_pcd(path), POINTS)


def test_a_header_that_promises_more_than_can_be_packed_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.pcd"
    path.write_bytes(FORMS["binary_compressed"].replace(b" 40\n", b" 4000000\n"))
    with pytest.raises(DataError, match="4000000 points cannot be in"):
        read_pcd(path)


@pytest.mark.parametrize("has_both", [False, True])
@pytest.mark.parametrize(("shift", "size"), [(0.0, "4 4 4"), (2_600_000.123, "8 8 8")])
def test_what_is_written_is_read_again_in_as_few_bytes_as_hold_it(
    tmp_path: Path, shift: float, size: str, has_both: bool
) -> None:
    carried = (COLOUR, STRENGTH) if has_both else (None, None)
    path = tmp_path / "out.pcd"
    assert not write_pcd(path, FileCloud(POINTS + shift, *carried, Place(crs="EPSG:2056")))
    text = path.read_bytes()
    assert b"# crs EPSG:2056\n" in text
    assert f"SIZE {size}{' 4 4' if has_both else ''}\n".encode() in text
    cloud = read_pcd_cloud(path)
    assert np.array_equal(cloud.points, POINTS + shift)
    for found, given in zip((cloud.colour, cloud.intensity), carried, strict=True):
        assert (found is None) if given is None else np.array_equal(found, given)


def test_a_colour_of_16_bits_is_rounded_and_that_is_told(tmp_path: Path) -> None:
    path = tmp_path / "out.pcd"
    deep = COLOUR.astype(np.uint16) * 257 + 1
    assert write_pcd(path, FileCloud(POINTS, deep))
    assert np.array_equal(read_pcd_cloud(path).colour, COLOUR)
