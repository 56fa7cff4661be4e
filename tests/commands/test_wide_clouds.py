"""Clouds wider than a site usually is: refused with the cure, taken if their user says so."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from executive.clouds.ply_writer import write_parts
from executive.commands.main import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    def called(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["executive", *words])
        with pytest.raises(SystemExit) as ended:
            main()
        return int(ended.value.code or 0), *capsys.readouterr()

    return called


@pytest.fixture
def wide(tmp_path: Path) -> str:
    """Return the file of a site with one stone, and of a point 700 m away from it."""
    rng = np.random.default_rng(4)
    ground = rng.uniform([-4, -4, -0.01], [4, 4, 0.01], (40_000, 3))
    skin = rng.normal(size=(8000, 3))
    stone = 0.5 * skin / np.linalg.norm(skin, axis=1)[:, None] + [0, 0, 0.2]
    write_parts(
        tmp_path / "wide.ply", [ground, stone[stone[:, 2] > 0], np.array([[700.0, 0.0, 0.0]])]
    )
    return str(tmp_path / "wide.ply")


def test_a_wide_cloud_is_refused_and_the_option_that_takes_it_is_named(run: Run, wide: str) -> None:
    status, _, told = run("segment", wide)
    assert status == 2
    assert "704" in told
    assert "raise that limit (--widest" in told


@pytest.mark.parametrize("words", [("--widest", "800"), ("--crop", "0,0,6")])
def test_a_wide_cloud_is_segmented_if_it_is_one_and_so_is_a_part_that_is_not_wide(
    run: Run, wide: str, words: tuple[str, str]
) -> None:
    status, answered, _ = run("segment", wide, *words, "--json")
    assert status == 0
    assert len(json.loads(answered)["segments"]) == 1


def test_what_is_wider_than_said_is_refused(run: Run, wide: str) -> None:
    status, _, told = run("segment", wide, "--widest", "600")
    assert status == 2
    assert "at most 600 m" in told


@pytest.mark.parametrize("verb", ["align", "register", "changes"])
def test_two_wide_clouds_are_refused_and_taken_by_the_same_option(
    run: Run, wide: str, verb: str
) -> None:
    status, _, told = run(verb, wide, wide)
    assert status == 2
    assert "--widest" in told
    assert "--widest" not in run(verb, wide, wide, "--widest", "800")[2]


def test_the_stone_of_a_wide_cloud_can_be_grasped(run: Run, wide: str) -> None:
    assert "--widest" in run("grasp", wide)[2]
    assert "--widest" not in run("grasp", wide, "--widest", "800")[2]
