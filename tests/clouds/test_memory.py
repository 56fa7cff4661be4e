"""A large cloud takes at most twice its file and 200 MB: measured on a process that reads one."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from executive.clouds.coloured_ply import write_parts

READER = """
import re, sys
from pathlib import Path
from executive.clouds.reader import read_site
points = read_site(Path(sys.argv[1]))
print(len(points), re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
"""


@pytest.mark.parametrize("single", [True, False])
def test_reading_takes_at_most_twice_the_file_and_200_mb(tmp_path: Path, single: bool) -> None:
    """In single precision and without colours, twice the file is what the points alone take as doubles."""
    count, path = (5_000_000, tmp_path / "large.ply") if single else (2_200_000, tmp_path / "large.ply")
    points = np.random.default_rng(0).uniform(0, 20, (count, 3)).astype(np.float32)
    if single:
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n"
        path.write_bytes(head.encode() + b"property float z\nend_header\n" + points.tobytes())
    else:
        write_parts(path, [points.astype(float)])
    ended = subprocess.run(
        [sys.executable, "-c", READER, path], capture_output=True, text=True, timeout=120, check=True
    )
    read, peak_kb = map(int, ended.stdout.split())
    assert read > 0.999 * count
    assert peak_kb * 1024 < 2 * path.stat().st_size + 200e6
