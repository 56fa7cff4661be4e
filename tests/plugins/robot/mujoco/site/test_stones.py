"""Generated stones have the statistics of found ones; scans are read strictly."""

from pathlib import Path

import numpy as np
import open3d as o3d
import pytest
from executive_plugins.physics.quarried_block import block
from executive_plugins.robot.mujoco.site.settings import StoneSettings
from executive_plugins.robot.mujoco.site.stone_meshes import read_skin
from executive_plugins.robot.mujoco.site.stones import make_stones
from pydantic import ValidationError
from scipy.spatial import ConvexHull

from executive.errors import ConfigError
from executive.geometry.solid import (
    inertia_about_origin,
    volume_and_centroid,
)

SCANS = Path(__file__).parents[5] / "shared" / "data" / "stones"


def box(*sides: float) -> o3d.geometry.TriangleMesh:
    return o3d.geometry.TriangleMesh.create_box(*sides)


def arrays(mesh: o3d.geometry.TriangleMesh) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(mesh.vertices), np.asarray(mesh.triangles).astype(np.int64)


def test_mass_properties_of_a_box_are_those_of_the_textbook() -> None:
    vertices, triangles = arrays(box(1.0, 2.0, 3.0))
    volume, centroid = volume_and_centroid(vertices, triangles)
    assert volume == pytest.approx(6.0)
    assert np.allclose(centroid, [0.5, 1.0, 1.5])
    inertia = inertia_about_origin(vertices - centroid, triangles, 2.0)
    assert np.allclose(inertia, np.diag([4 + 9, 1 + 9, 1 + 4]) * 12.0 / 12)


def test_blocks_have_the_volume_and_the_ratios_that_are_asked_for() -> None:
    rng = np.random.default_rng(0)
    blocks = [block(0.7, rng) for _ in range(300)]
    sides = np.array([np.ptp(corners, axis=0) for corners in blocks])
    assert np.allclose([ConvexHull(corners).volume for corners in blocks], 0.7)
    b_a, c_b = sides[:, 1] / sides[:, 0], sides[:, 2] / sides[:, 1]
    # Cut-off Gaussians: the mean of 300 draws is good to 0.13/√300 = 0.008, twice that is allowed.
    assert b_a.mean() == pytest.approx(0.75, abs=0.02)
    assert b_a.std() == pytest.approx(0.12, abs=0.02)
    assert c_b.mean() == pytest.approx(0.69, abs=0.02)
    assert c_b.std() == pytest.approx(0.14, abs=0.025)
    assert b_a.max() <= 1
    assert min(len(corners) for corners in blocks) >= 8  # more than a bare box once corners are off


def test_stones_weigh_what_their_volume_and_density_say() -> None:
    stones = make_stones(
        StoneSettings(count=12, density_kg_m3=2500), 3000.0, np.random.default_rng(1)
    )
    assert [stone.name for stone in stones] == [f"stone_{i}" for i in range(1, 13)]
    for stone in stones:
        volume, centroid = volume_and_centroid(stone.vertices, stone.triangles)
        assert 0.5 <= volume <= 1.0
        assert stone.mass_kg == pytest.approx(2500 * volume)
        assert np.allclose(centroid, 0.0, atol=1e-9)
        # What touches and what is seen are the same block but for bumps of 8 mm on faces of some
        # square metres.
        assert ConvexHull(stone.hull).volume == pytest.approx(volume, rel=0.03)
        assert (np.linalg.eigvalsh(stone.inertia) > 0).all()


def test_one_seed_gives_one_set_of_stones() -> None:
    first, again, other = (
        make_stones(StoneSettings(count=3), 3000.0, np.random.default_rng(s)) for s in (5, 5, 6)
    )
    assert all(np.array_equal(a.vertices, b.vertices) for a, b in zip(first, again, strict=True))
    assert not any(a.mass_kg == b.mass_kg for a, b in zip(first, other, strict=True))


def test_reads_obj_ply_and_stl_and_turns_their_faces_outwards(tmp_path: Path) -> None:
    mesh = box(0.1, 0.08, 0.06)
    mesh.triangles = o3d.utility.Vector3iVector(np.asarray(mesh.triangles)[:, ::-1])  # inside out
    for suffix in ("obj", "ply", "stl"):
        mesh.compute_triangle_normals()
        assert o3d.io.write_triangle_mesh(tmp_path / f"a.{suffix}", mesh)
        volume, _ = volume_and_centroid(*read_skin(tmp_path / f"a.{suffix}", 10.0))
        assert volume == pytest.approx(0.48, rel=1e-5)


def test_takes_only_meshes_that_can_be_lifted_each_once(tmp_path: Path) -> None:
    for i, side in enumerate((0.5, 0.6, 0.7, 2.0)):
        o3d.io.write_triangle_mesh(tmp_path / f"{i}.ply", box(side, side, side))
    stones = make_stones(StoneSettings(count=3, folder=tmp_path), 3000.0, np.random.default_rng(0))
    assert sorted(round(stone.mass_kg) for stone in stones) == [338, 583, 926]
    with pytest.raises(
        ConfigError, match=r"only 3 of the 4 meshes .* weigh at most 3000 kg .* 4 are wanted: lower"
    ):
        make_stones(StoneSettings(count=4, folder=tmp_path), 3000.0, np.random.default_rng(0))
    assert len(
        make_stones(
            StoneSettings(count=4, folder=tmp_path, max_mass_kg=30000),
            3000.0,
            np.random.default_rng(0),
        )
    )


@pytest.mark.parametrize(
    ("write", "words"),
    [
        (lambda f: None, r"holds no mesh \(\.obj, \.ply, \.stl\)"),
        (
            lambda f: (f / "a.obj").write_text("this is no mesh\n"),
            r"a\.obj: not a readable mesh; export it again",
        ),
        (lambda f: (f / "a.ply").write_bytes(b"\x00" * 99), r"a\.ply: not a PLY file"),
        (
            lambda f: o3d.io.write_triangle_mesh(f / "a.ply", box(300, 200, 100)),
            r"a\.ply: 300 m across at scale 1, .*\.scale",
        ),
        (
            lambda f: o3d.io.write_triangle_mesh(f / "a.ply", box(0.01, 0.01, 0.01)),
            r"0\.01 m across .* set .*\.scale",
        ),
    ],
)
def test_refuses_a_folder_that_holds_no_stones(tmp_path: Path, write: object, words: str) -> None:
    write(tmp_path)  # type: ignore[operator]
    with pytest.raises(ConfigError, match=words):
        make_stones(StoneSettings(count=1, folder=tmp_path), 3.0, np.random.default_rng(0))


def test_refuses_a_mesh_with_a_hole(tmp_path: Path) -> None:
    mesh = box(1, 1, 1)
    mesh.triangles = o3d.utility.Vector3iVector(np.asarray(mesh.triangles)[1:])
    o3d.io.write_triangle_mesh(tmp_path / "open.ply", mesh)
    with pytest.raises(ConfigError, match=r"open\.ply: the mesh is not closed.* fill its holes"):
        make_stones(StoneSettings(count=1, folder=tmp_path), 3000.0, np.random.default_rng(0))


def test_refuses_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError, match=r"robot\.site\.stones\.folder: '.*nowhere' is not a folder"
    ):
        make_stones(StoneSettings(folder=tmp_path / "nowhere"), 3000.0, np.random.default_rng(0))


@pytest.mark.parametrize("volume", [(1.0, 0.5), (0.0, 1.0), (1.0, 50.0)])
def test_refuses_absurd_volumes(volume: tuple[float, float]) -> None:
    with pytest.raises(ValidationError, match="volume_m3"):
        StoneSettings(volume_m3=volume)


@pytest.mark.skipif(not SCANS.is_dir(), reason="the scans are not part of the project")
def test_real_scans_at_scale_10_are_stones_of_half_a_cubic_metre() -> None:
    settings = StoneSettings(count=40, folder=SCANS, scale=10.0)
    volumes = [stone.volume_m3 for stone in make_stones(settings, 3000.0, np.random.default_rng(0))]
    assert 0.4 < np.median(volumes) < 0.7
    assert max(volumes) <= 3000 / 2700


@pytest.mark.parametrize("seed", range(4))
def test_a_mesh_with_a_hole_is_refused_whether_it_would_be_drawn_or_not(
    tmp_path: Path, seed: int
) -> None:
    for i in range(3):
        o3d.io.write_triangle_mesh(tmp_path / f"{i}.ply", box(0.5, 0.5, 0.5))
    holed = box(1, 1, 1)
    holed.triangles = o3d.utility.Vector3iVector(np.asarray(holed.triangles)[1:])
    o3d.io.write_triangle_mesh(tmp_path / "holed.ply", holed)
    with pytest.raises(ConfigError, match=r"holed\.ply: the mesh is not closed"):
        make_stones(StoneSettings(count=1, folder=tmp_path), 3e3, np.random.default_rng(seed))


def test_generated_stones_fit_a_machine_that_carries_less() -> None:
    stones = make_stones(StoneSettings(count=9), 1000.0, np.random.default_rng(1))
    assert all(500.0 <= stone.mass_kg <= 1000.0 for stone in stones)
    given = StoneSettings(count=9, volume_m3=(0.9, 1.0))
    heavy = make_stones(given, 1000.0, np.random.default_rng(1))  # what is asked for is drawn
    assert all(stone.mass_kg >= 0.9 * 2700.0 for stone in heavy)


def test_each_stone_may_have_a_density_of_its_own() -> None:
    densities = [2300.0, 2700.0, 3100.0]
    stones = make_stones(StoneSettings(count=3), 9e3, np.random.default_rng(1), densities)
    assert [stone.mass_kg / stone.volume_m3 for stone in stones] == pytest.approx(densities)


@pytest.mark.parametrize("roughness_m", [0.0, 0.01, 0.03])
def test_the_skin_and_the_hull_of_a_generated_stone_have_one_volume(roughness_m: float) -> None:
    settings = StoneSettings(count=3, roughness_m=roughness_m)
    for stone in make_stones(settings, 9e3, np.random.default_rng(3)):
        skin_m3, _ = volume_and_centroid(stone.vertices, stone.triangles)
        assert skin_m3 == pytest.approx(ConvexHull(stone.hull).volume, rel=1e-9)
