"""Clouds in each form of file, whole, cut short by a byte, and with headers that lie."""

import logging
from pathlib import Path

import numpy as np
import pytest

from executive.clouds.lzf import Unpacker
from executive.clouds.ply_writer import write_parts, write_ply
from executive.clouds.point_collector import PointCollector
from executive.clouds.reader import read_points, read_site
from executive.clouds.text_rows import count_lines
from executive.clouds.units import check_site, unit_hint
from executive.errors import DataError

POINTS = np.random.default_rng(1).integers(-400, 400, (12, 3)) / 16.0
LINES = "".join(f"{x} {y} {z}\n" for x, y, z in POINTS)


def told_of(call, folder: Path) -> object:
    """Return the answer, or the refusal without the folder's name."""
    try:
        return call()
    except DataError as error:
        return str(error).replace(str(folder), "")


def ply(
    form: str, body: bytes, properties: str = "xyz", before: str = "", count: int = 12
) -> bytes:
    fields = "".join(f"property double {name}\n" for name in properties)
    header = (
        f"ply\nformat {form} 1.0\ncomment a\n{before}element vertex {count}\n{fields}end_header\n"
    )
    return header.encode() + body


PCD_FIELDS = {
    "VERSION": ".7",
    "FIELDS": "x y z i",
    "SIZE": "4 4 4 2",
    "TYPE": "F F F U",
    "COUNT": "1 1 1 2",
    "WIDTH": "12",
    "HEIGHT": "1",
    "POINTS": "12",
}


def pcd(form: str, body: bytes, **changed: str) -> bytes:
    lines = [f"{key} {value}" for key, value in (PCD_FIELDS | changed).items() if value]
    return "\n".join(["# .PCD v.7", *lines, f"DATA {form}", ""]).encode() + body


ROWS = np.zeros(12, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("i", "<u2", 2)])
ROWS["x"], ROWS["y"], ROWS["z"], ROWS["i"] = *POINTS.T, 7
COLUMNS = b"".join(np.ascontiguousarray(ROWS[name]).tobytes() for name in ("x", "y", "z", "i"))
LITERAL = b"".join(
    bytes([len(COLUMNS[k : k + 32]) - 1]) + COLUMNS[k : k + 32] for k in range(0, len(COLUMNS), 32)
)
LENGTHS = np.array([len(LITERAL), len(COLUMNS)], "<u4").tobytes()
FACE = "element face 2\nproperty list uchar int i\n"
EXTRA = "element camera 2\nproperty double a\nproperty float b\n"
FILES = {
    "binary.ply": ply("binary_little_endian", POINTS.tobytes()),
    "big.ply": ply("binary_big_endian", POINTS.astype(">f8").tobytes()),
    "text.ply": ply("ascii", LINES.encode()),
    "reversed.ply": ply("ascii", LINES.encode(), "zyx"),
    "before.ply": ply("binary_little_endian", b"\1" * 24 + POINTS.tobytes(), before=EXTRA),
    "lines before.ply": ply("ascii", b"1 2\n3 4\n" + LINES.encode(), before=EXTRA),
    "lists before.ply": ply("binary_little_endian", POINTS.tobytes(), before=FACE),
    "negative.ply": ply("ascii", LINES.encode(), count=-1),
    "no z.ply": ply("ascii", LINES.encode(), "xy"),
    "other.ply": ply("utf", LINES.encode()),
    "binary.pcd": pcd("binary", ROWS.tobytes()),
    "text.pcd": pcd("ascii", LINES.replace("\n", " 1 2\n").encode()),
    "packed.pcd": pcd("binary_compressed", LENGTHS + LITERAL),
    "size.pcd": pcd("binary", ROWS.tobytes(), WIDTH="11"),
    "count.pcd": pcd("binary", ROWS.tobytes(), COUNT="2 1 1 1"),
    "form.pcd": pcd("text", ROWS.tobytes()),
    "plain.pcd": pcd("ascii", LINES.encode(), FIELDS="x y z", SIZE="4 4 4", TYPE="", COUNT=""),
    "negative.pcd": pcd("ascii", b"", POINTS="-1", WIDTH="-1"),
    "a.xyz": LINES.encode(),
    "titles.csv": b"x;y;z\n" + LINES.replace(" ", ";").encode(),
    "commas.csv": LINES.replace(".", ",").encode(),
    "count.pts": b"12\n" + LINES.encode(),
    "comments.txt": b"\xef\xbb\xbf# a\n\n" + LINES.replace("\n", " // b\n", 3).encode(),
    "bad.xyz": LINES.encode() + b"1 2\n" + LINES.encode(),
    "nan.xyz": b"nan 1 2\ninf 0 0\n" + 2 * LINES.encode(),
    "none.xyz": b"nan 1 2\n",
    "empty.xyz": b"",
    "far.xyz": b"1e7 0 0\n1.1e7 0 0\n",
    "limit.xyz": b"1e7 0 0\n-1e7 0 0\n",
    "utf16.xyz": LINES.encode("utf-16"),
    "gzip.xyz": b"\x1f\x8b" + b"0" * 9,
    "a.obj": LINES.encode(),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_files(recorded, tmp_path, caplog, name) -> None:
    caplog.set_level(logging.WARNING)
    path, whole = tmp_path / name, FILES[name]
    told = []
    for missing in (0, 1, 9, 40):
        path.write_bytes(whole[: len(whole) - missing])
        told.append(told_of(lambda: read_points(path), tmp_path))
    logged = [message.replace(str(tmp_path), "") for message in caplog.messages]
    recorded((told, logged, count_lines(path)))


def test_packed_bytes(recorded) -> None:
    told = []
    for packed in (
        [2, 65, 66, 67, 0x20, 0],
        [1, 65, 66, 0x40, 1, 0xE0, 3, 0],
        [0, 65, 0x20, 1],
        [31, 1],
        [0, 65, 0xE0],
        [0, 65, 0xE0, 1],
        [0, 65, 0x21, 0],
        [],
    ):
        told += [Unpacker(np.array(packed, np.uint8)).take(size) for size in (0, 3, 5, 40)]
    recorded(told)


def test_many_points_are_thinned(recorded, monkeypatch, caplog) -> None:
    monkeypatch.setattr("executive.clouds.point_collector.MOST", 400)
    monkeypatch.setattr("executive.clouds.point_collector.CHUNK", 128)
    caplog.set_level(logging.WARNING)
    collector, rng = PointCollector(Path("a.xyz"), 10_000), np.random.default_rng(2)
    for _ in range(4):
        collector.add(*rng.integers(0, 60, (3, 300)) / 400.0)
    recorded((collector.points(), caplog.messages))
    with pytest.raises(DataError) as refused:
        PointCollector(Path("a.xyz"), 500_000_001)
    PointCollector(Path("a.xyz"), 500_000_000)
    recorded(refused.value)


def test_written_files(recorded, tmp_path) -> None:
    write_ply(tmp_path / "a.ply", POINTS, "map")
    write_parts(tmp_path / "b.ply", [POINTS[:3], POINTS[:0], POINTS[3:5], POINTS[5:]])
    told = [(tmp_path / name).read_bytes() for name in ("a.ply", "b.ply")]
    recorded((told, read_points(tmp_path / "b.ply")))


def box(*sides: float, count: int = 500) -> np.ndarray:
    return np.random.default_rng(3).uniform(-0.5, 0.5, (count, 3)) * sides


def test_units(recorded, tmp_path) -> None:
    far = np.vstack([box(20, 20, 2), [[600.0, 0, 0]]])
    national = np.round(box(20, 20, 2) * 8) / 8 + (2.6e6, 1.2e6, 400)
    clouds = [
        box(20, 20, 2), box(600, 5, 5), box(5e5, 5, 5), box(499.9, 5, 5), far, national,
        box(2e4, 5, 5), box(0.49, 0.4, 0.4), box(0.6, 0.4, 0.4), box(0.002, 0.001, 3.0),
        box(0.002, 0.001, 0.03), box(0.002, 0.001, 3.0) + (181, 0, 0),
        box(0.002, 0.001, 3.0) + (0, 91, 0), national + box(1, 1, 1), box(60, 60, 9, count=60_000),
    ]  # fmt: skip
    told = [told_of(lambda cloud=cloud: check_site(Path("a"), cloud), tmp_path) for cloud in clouds]
    for factor in (1000, 100, 39.37, 3.2808, 1, 0.001, 0.3, 0.28, 3.8, 3.6):
        told += [unit_hint(box(9, 9, 9) * factor, box(9, 9, 9))]
    (tmp_path / "a.xyz").write_text(LINES)
    recorded((told, read_site(tmp_path / "a.xyz")))
