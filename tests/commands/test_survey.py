"""The verb `survey` refuses what it cannot do before it computes anything."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

EXECUTIVE = Path(sys.executable).with_name("executive")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["nowhere", "--out", "cloud.ply"],
            r"nowhere: no such folder; give one that holds a drone's pictures",
        ),
        (["nowhere", "--out", "cloud.xyz"], r"--out: cloud.xyz: name a .ply or .pcd"),
        (
            ["nowhere", "--out", "cloud.ply", "--view-angle", "1.2"],
            r"--view-angle: 1.2 is not within 6 to 160 degrees",
        ),
    ],
)
def test_wrong_input_ends_with_status_2_and_one_line(
    words: list[str], message: str, tmp_path: Path
) -> None:
    done = subprocess.run(
        [EXECUTIVE, "survey", *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 2
    assert re.search(message, done.stderr)
    assert "Traceback" not in done.stderr
