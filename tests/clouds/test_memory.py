"""A large cloud takes at most twice its file and 200 MB: measured on processes that read one."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from executive.clouds.ply_writer import write_parts
from executive.clouds.point_collector import MOST, MOST_APART

PEAK = """
print("peak", re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
"""
READER = f"""
import re, sys
from pathlib import Path
from executive.clouds.reader import read_site
print(len(read_site(Path(sys.argv[1]))))
{PEAK}
"""
ADDED = f"""
import re, sys
from pathlib import Path
from executive.clouds.reader import read_points
read_points(Path(sys.argv[1]))  # compiles what unpacks
print("before", re.search(r"VmRSS:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
print("points", len(read_points(Path(sys.argv[2]))))
{PEAK}
"""
COMMAND = f"""
import re, sys
from pathlib import Path
from executive.commands.main import main
try:
    main()
except SystemExit as ended:
    assert not ended.code
{PEAK}
"""


def run(program: str, *words: object) -> tuple[str, int]:
    """Return what a program printed and its largest memory in bytes."""
    ended = subprocess.run(
        [sys.executable, "-c", program, *map(str, words)],
        capture_output=True,
        text=True,
        timeout=240,
        check=True,
    )
    return ended.stdout + ended.stderr, 1024 * int(re.search(r"peak (\d+)", ended.stdout)[1])


def write_floats(path: Path, points: np.ndarray) -> None:
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    path.write_bytes(head.encode() + b"end_header\n" + points.astype(np.float32).tobytes())


def blocks(path: Path, count: int) -> Path:
    """Write the tops and sides of three blocks on a floor."""
    rng = np.random.default_rng(0)
    points = rng.uniform([-6, -6, 0], [6, 6, 0.01], (count, 3))
    for x, rows in zip((-3, 0, 3), np.split(points[: 9 * count // 65], 3), strict=True):
        low, high = np.array([x, -0.5, 0.0]), np.array([x + 1.0, 0.5, 0.7])
        rows[:] = rng.uniform(low, high, rows.shape)
        axis = rng.integers(0, 3, len(rows))
        ends = np.where((rng.random(len(rows)) < 0.5) & (axis < 2), low[axis], high[axis])
        rows[np.arange(len(rows)), axis] = ends
    write_floats(path, points)
    return path


@pytest.mark.parametrize("single", [True, False])
def test_reading_takes_at_most_twice_the_file_and_200_mb(tmp_path: Path, single: bool) -> None:
    """In single precision and without colours, twice the file is what the points alone would take
    as doubles.
    """
    count, path = (3_500_000 if single else 2_200_000), tmp_path / "large.ply"
    points = np.random.default_rng(0).uniform(0, [20, 20, 0.1], (count, 3))
    write_floats(path, points) if single else write_parts(path, [points])
    printed, peak = run(READER, path)
    # In single precision half of what may be kept is nearer than 3 cm to nothing else.
    assert MOST / 4 < int(printed.split()[0]) <= MOST_APART
    assert peak < 2 * path.stat().st_size + 200e6


def test_segmenting_a_large_file_takes_at_most_twice_the_file_and_200_mb(tmp_path: Path) -> None:
    """Six and a half million points in 78 MB; a small cloud before them,
    for what is compiled once.
    """
    run(COMMAND, "segment", blocks(tmp_path / "small.ply", 65_000))
    path = blocks(tmp_path / "large.ply", 6_500_000)
    printed, peak = run(COMMAND, "segment", path)
    assert "3 segments" in printed
    assert peak < 2 * path.stat().st_size + 200e6


def compressed_zeros(path: Path, count: int) -> int:
    """Write a compressed PCD of zeros, behind 33 numbers a point; return what it unpacks to."""
    size = count * 36 * 4
    whole, rest = divmod(size - 1, 264)  # a literal zero, then references of 264 bytes to it
    packed = bytes([0, 0]) + bytes([0xE0, 255, 0]) * whole
    packed += b"".join(bytes([0, 0]) for _ in range(rest))
    head = "FIELDS form x y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 33 1 1 1\n"
    head += f"POINTS {count}\nDATA binary_compressed\n"
    lengths = np.array([len(packed), size], "<u4").tobytes()
    path.write_bytes(head.encode() + lengths + packed)
    return size


def test_unpacking_takes_at_most_twice_the_file_and_200_mb(tmp_path: Path) -> None:
    small, path = tmp_path / "small.pcd", tmp_path / "packed.pcd"
    compressed_zeros(small, 1000)
    assert compressed_zeros(path, 4_000_000) > 80 * path.stat().st_size
    printed, peak = run(ADDED, small, path)
    assert "points 1\n" in printed  # all lie at one place
    before = 1024 * int(re.search(r"before (\d+)", printed)[1])
    assert peak - before < 2 * path.stat().st_size + 200e6
