"""The page on clouds is true: its command runs, and its table names every kind that can be read."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from executive.clouds.ply_writer import write_parts
from executive.clouds.reader import _READERS
from executive.commands.main import main
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "clouds.md").read_text(encoding="utf-8")


def step(seed: int) -> np.ndarray:
    """A block in a corner of ground and wall."""
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-0.5, 0.5, (2, 6000))
    flat = np.zeros(6000)
    parts = [
        (u, v, flat + 0.4),
        (flat + 0.5, u, 0.8 * v),
        (u, flat - 0.5, 0.8 * v),
        (3 * u, 3 * v, flat - 0.4),
    ]
    return np.vstack([np.column_stack(part) for part in parts]) + rng.normal(0, 0.005, (24_000, 3))


def test_the_command_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    T = pose(from_rpy(0, 0, np.radians(7)), np.array([0.13, 0.02, 0.0]))
    write_parts(Path("source.ply"), [transform(inverse(T), step(1))])
    write_parts(Path("target.ply"), [step(2)])
    command = re.search(r"```sh\n(.*?)\n```", PAGE, re.S).group(1)
    monkeypatch.setattr("sys.argv", shlex.split(command))
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    assert Path("both.ply").is_file()


def test_every_kind_is_named() -> None:
    rows = re.search(r"\| kind \|.*?\n\n", PAGE, re.S).group(0)
    assert set(re.findall(r"\b[A-Z][A-Z0-9]{2}\b", rows)) == {
        suffix[1:].upper() for suffix in _READERS
    }
