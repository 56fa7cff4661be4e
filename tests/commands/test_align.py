"""`executive align`: from a guess of any form to a motion that is believed, or a reason."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from executive.clouds.coordinate_system import coordinate_system
from executive.clouds.ply_writer import write_parts
from executive.clouds.reader import read_points
from executive.commands.clouds.guess import read_guess
from executive.errors import ConfigError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between, from_rpy

T_TRUE = pose(from_rpy(0.02, -0.03, 1.1), np.array([6.0, -4.0, 2.0]))


def corner(seed: int) -> np.ndarray:
    """Three faces of a block on the ground, freshly sampled by each seed."""
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-0.5, 0.5, (2, 8000))
    faces = [
        np.column_stack([u, v, np.full(8000, 0.4)]),
        np.column_stack([np.full(8000, 0.5), u, 0.8 * v]),
    ]
    faces += [
        np.column_stack([u, np.full(8000, -0.5), 0.8 * v]),
        np.column_stack([3 * u, 3 * v, np.full(8000, -0.4)]),
    ]
    return np.vstack(faces) + rng.normal(0, 0.006, (32_000, 3))


def align(*words: object) -> subprocess.CompletedProcess:
    arguments = ["executive", "align", *map(str, words)]
    code = f"import sys; sys.argv = {arguments!r}; from executive.commands.main import main; main()"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)


@pytest.fixture(scope="module")
def clouds(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("clouds")
    write_parts(folder / "source.ply", [transform(inverse(T_TRUE), corner(1)) / 1.02])
    write_parts(folder / "target.ply", [corner(2)], "EPSG:2056")
    return folder / "source.ply", folder / "target.ply"


@pytest.mark.parametrize("method", ["gicp", "point_to_plane"])
def test_a_scaled_answer_of_another_command_is_refined(
    clouds: tuple[Path, Path], tmp_path: Path, method: str
) -> None:
    T_near = T_TRUE @ pose(from_rpy(0.02, 0.01, -0.03), np.array([0.05, -0.04, 0.06]))
    (tmp_path / "guess.json").write_text(json.dumps({"T": T_near.tolist(), "scale": 1.02}))
    ended = align(
        *clouds,
        "--guess",
        tmp_path / "guess.json",
        "--method",
        method,
        "--json",
        "--out",
        tmp_path / "o.ply",
    )
    assert ended.returncode == 0, ended.stderr
    found = json.loads(ended.stdout)
    T = np.array(found["T"])
    assert found["accepted"]
    assert found["scale"] == 1.02
    assert (
        np.linalg.norm(T[:3, 3] - T_TRUE[:3, 3]) < 0.03
    )  # faces of 6 mm noise, 7 m away from the frame's origin
    assert angle_between(T[:3, :3], T_TRUE[:3, :3]) < np.radians(0.3)
    assert {"reason", "rmse_m", "overlap", "timings_ms"} <= set(found)
    assert found["crs"] == coordinate_system(tmp_path / "o.ply") == "EPSG:2056"
    assert len(read_points(tmp_path / "o.ply")) == 64_000


def test_a_refusal_has_status_1_and_a_reason(clouds: tuple[Path, Path], tmp_path: Path) -> None:
    ended = align(*clouds, "--out", tmp_path / "o.ply", "--json")
    assert ended.returncode == 1
    assert "refused: no target within reach of the source at the guess" in ended.stderr
    assert not json.loads(ended.stdout)["accepted"]
    assert not (tmp_path / "o.ply").exists()


def test_a_source_in_feet_is_suspected(clouds: tuple[Path, Path], tmp_path: Path) -> None:
    write_parts(tmp_path / "feet.ply", [corner(1) / 0.3048])
    ended = align(tmp_path / "feet.ply", clouds[1])
    assert ended.returncode == 1
    assert "the source is 3.28 times as large as the other cloud: is it in feet?" in ended.stderr


def test_numbers_are_metres_and_degrees() -> None:
    np.testing.assert_allclose(
        read_guess("6,-4,2,0,0,90")[0], pose(from_rpy(0, 0, np.pi / 2), np.array([6.0, -4, 2]))
    )
    np.testing.assert_allclose(read_guess("6,-4,2")[0], pose(None, np.array([6.0, -4, 2])))
    np.testing.assert_array_equal(read_guess(None)[0], np.eye(4))


def test_a_printed_matrix_is_made_a_rotation_again(tmp_path: Path) -> None:
    (tmp_path / "T.txt").write_text("\n".join(" ".join(f"{x:.4f}" for x in row) for row in T_TRUE))
    T, scale = read_guess(str(tmp_path / "T.txt"))
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(T, T_TRUE, atol=1e-4)
    assert scale == 1.0


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "neither numbers nor a file; give x,y,z"),
        ('{"answer": 42}', "holds no 4×4 matrix"),
        ("1 0 0\n0 1 0\n0 0 1\n", "holds no 4×4 matrix"),
        ("2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n", "scales or mirrors"),
        ("1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n", "scales or mirrors"),
    ],
)
def test_a_guess_that_is_none_is_named(tmp_path: Path, content: str | None, words: str) -> None:
    path = tmp_path / "guess.txt"
    if content is not None:
        path.write_text(content)
    with pytest.raises(ConfigError, match=words):
        read_guess(str(path))


@pytest.mark.parametrize("text", ["1,2", "1,2,3,4", "1,2,nan"])
def test_too_few_numbers_are_named(text: str) -> None:
    with pytest.raises(ConfigError, match="not 3 or 6 finite ones"):
        read_guess(text)
