"""From a small simulated site's pictures to a cloud: where it should be, as surely as it says,
twice the same.
"""

from pathlib import Path
from typing import Any

import numpy as np
import open3d as o3d
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.site.ray_mesh import joined, moved
from executive_plugins.surveying import photogrammetry, structure_from_motion
from executive_plugins.surveying.colmap import Colmap
from executive_plugins.surveying.grid_flight import fly, recorded
from executive_plugins.surveying.photogrammetry import Photogrammetry, reconstruct
from executive_plugins.surveying.photograph_folder import Photographs, read_photographs
from executive_plugins.surveying.settings import (
    ColmapSettings,
    GridFlightSettings,
    PhotogrammetrySettings,
    SimulatedPhotographsSettings,
)
from executive_plugins.surveying.simulated_photographs import SimulatedPhotographs, take_photographs
from executive_plugins.surveying.structure_from_motion import load_pycolmap
from PIL import Image

from executive.arrays import Float
from executive.errors import ConfigError, DataError
from executive.geometry.rigid_fit import similarity_fit
from executive.interfaces.robot import Robot
from executive.machine.machine import load_machine

FLIGHT = GridFlightSettings(
    strips=3,
    pictures=4,
    size_m=(6, 7),
    height_m=6,
    size_px=(640, 480),
    noise_m=0.1,
    centre_m=(5, 0),
)
SETTINGS = PhotogrammetrySettings.model_validate(
    {"motion": {"features": 1500, "neighbours": 6}, "depth": {"pixel_m": 0.025}}
)


class Flight:
    """One site, its pictures, and where they were really taken."""

    def __init__(self, folder: Path) -> None:
        placement = {"sector_width_rad": 0.8, "min_radius_m": 3.5, "max_radius_m": 6.5}
        site = {"terrain": {"half_size_m": 9}, "stones": {"count": 3, "placement": placement}}
        self.robot = MujocoRobot(
            MujocoSettings.model_validate({"site": site}),
            load_machine("m545"),
            np.random.default_rng(5),
        )
        self.robot.start()
        self.poses = np.array(
            take_photographs(self.robot, FLIGHT, folder, np.random.default_rng(5))
        )
        self.photographs = read_photographs(folder, None, 6)

    def distances(self, points: Float) -> Float:
        """Return how far points (N, 3) in the world are from ground and stones [m]."""
        site = self.robot.world.site
        skins = [
            moved((s.vertices, s.triangles), T)
            for s, T in zip(site.stones, site.T_world_stones, strict=True)
        ]
        vertices, triangles = joined([site.terrain.mesh(), *skins])
        scene = o3d.t.geometry.RaycastingScene(nthreads=1)
        scene.add_triangles(
            o3d.core.Tensor(vertices.astype(np.float32)),
            o3d.core.Tensor(triangles.astype(np.uint32)),
        )
        return np.asarray(
            scene.compute_distance(o3d.core.Tensor(points.astype(np.float32))).numpy()
        )


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Flight:
    return Flight(tmp_path_factory.mktemp("photographs"))


def test_pictures_become_the_site_to_centimetres(flight: Flight) -> None:
    found = reconstruct(flight.photographs, SETTINGS, np.random.default_rng(1))
    assert len(found.names) == 12
    true = flight.poses[:, :3, 3]
    scale, R, t = similarity_fit(true, found.centres_m)
    # A tenth of a pixel at 6 m is 1 mm; twelve pictures leave some of the common bend in.
    assert np.linalg.norm(scale * found.centres_m @ R.T + t - true, axis=1).max() < 0.02
    assert abs(1 / scale - 1) < 4 * found.alignment.scale_error
    assert found.alignment.scale_error < 0.02
    points = scale * found.cloud.points @ R.T + t
    distances = flight.distances(points)
    assert len(points) > 15_000
    assert np.median(distances) < 0.012
    assert np.percentile(distances, 95) < 0.05
    for T in flight.robot.world.site.T_world_stones:
        assert (np.linalg.norm(points - T[:3, 3], axis=1) < 0.8).sum() > 300
    ground = points[:, 2] < 0.05
    assert np.median((found.cloud.normals @ R.T)[ground, 2]) > 0.97


SOME = PhotogrammetrySettings.model_validate(
    {
        "motion": {"features": 800, "neighbours": 5},
        "depth": {"pixel_m": 0.05},
        "max_scale_error": 0.5,
    }
)


def some(flight: Flight) -> Photographs:
    pictures = flight.photographs
    return Photographs(
        pictures.folder, pictures.names[:6], pictures.positions_m[:6], pictures.size_px
    )


@pytest.fixture(scope="module")
def whole(flight: Flight) -> Photogrammetry:
    settings = SOME.model_copy(update={"depth": SOME.depth.model_copy(update={"threads": 1})})
    return reconstruct(some(flight), settings, np.random.default_rng(7))


def test_one_seed_gives_one_cloud_to_the_last_bit_in_any_number_of_threads(
    flight: Flight, whole: Photogrammetry
) -> None:
    told: list[str] = []
    again = reconstruct(some(flight), SOME, np.random.default_rng(7), told.append)
    assert len(whole.cloud) > 1000
    assert np.array_equal(whole.cloud.points, again.cloud.points)
    assert np.array_equal(whole.cloud.normals, again.cloud.normals)
    assert np.array_equal(whole.centres_m, again.centres_m)
    assert told[1] == "6 of 6 pictures in place"
    assert sum(line.startswith("depth of picture") for line in told) == 6


def test_one_that_was_cut_off_goes_on_where_it_was(
    flight: Flight, whole: Photogrammetry, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    work, made, measure = tmp_path / "work", list[Float](), photogrammetry.measure_depth
    most = 2

    def cut_off(*given: Any) -> Float:
        if len(made) == most:
            raise KeyboardInterrupt
        made.append(measure(*given))
        return made[-1]

    monkeypatch.setattr(photogrammetry, "measure_depth", cut_off)
    one = SOME.model_copy(update={"depth": SOME.depth.model_copy(update={"threads": 1})})
    with pytest.raises(KeyboardInterrupt):
        reconstruct(some(flight), one, np.random.default_rng(7), kept=work)
    done = sorted(path.name for path in work.glob("depth_*.npy"))
    assert done == ["depth_00000.npy", "depth_00001.npy"]
    monkeypatch.setattr(structure_from_motion, "_solve", None)  # places are not searched again
    most = 6
    again = reconstruct(some(flight), one, np.random.default_rng(7), kept=work)
    assert len(made) == most
    assert np.array_equal(whole.cloud.points, again.cloud.points)
    assert not work.exists()


def test_pictures_of_nothing_in_common_find_no_place(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    lines = ["name,x,y,z"]
    for i in range(6):
        noise = Image.fromarray(rng.integers(0, 255, (24, 32, 3), dtype=np.uint8)).resize(
            (320, 240)
        )
        noise.save(tmp_path / f"{i}.png")
        lines.append(f"{i}.png,{i % 2},{i},8")
    (tmp_path / "positions.csv").write_text("\n".join(lines))
    survey = Colmap(
        ColmapSettings.model_validate({"photographs": tmp_path, "motion": {"features": 500}})
    )
    survey.start()
    with pytest.raises(
        DataError, match=r"0 of 6 pictures found their place, at least 70% are wanted; lost: 0.png"
    ):
        survey.survey(np.random.default_rng(0))


def test_a_missing_package_is_named_with_its_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("executive.extras._is_installed", lambda name: name != "pycolmap")
    with pytest.raises(
        ConfigError, match=r"not installed: pycolmap\): pip install \"executive\[photogrammetry\]\""
    ):
        load_pycolmap()


def test_a_robot_without_a_site_is_named(tmp_path: Path) -> None:
    class Blind:
        """A robot without surroundings."""

    survey = SimulatedPhotographs(SimulatedPhotographsSettings(), Blind())  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match="the robot Blind has none; use colmap with a folder"):
        survey.start()


def test_pictures_are_not_mixed_with_what_a_folder_holds(tmp_path: Path, flight: Flight) -> None:
    (tmp_path / "old.jpg").touch()
    robot: Robot = flight.robot
    survey = SimulatedPhotographs(SimulatedPhotographsSettings(folder=tmp_path), robot)
    with pytest.raises(ConfigError, match="is there already and not empty"):
        survey.survey(np.random.default_rng(0))


def test_a_flight_goes_to_and_fro_and_looks_inwards() -> None:
    settings = GridFlightSettings(unsteadiness_m=0)
    poses = np.array(fly(settings, np.random.default_rng(0)))
    assert poses.shape == (36, 4, 4)
    steps = np.linalg.norm(np.diff(poses[:, :2, 3], axis=0), axis=1)
    assert steps.max() < 3.4  # neighbours in time are neighbours in space
    for T in poses:
        forward, outwards = T[:3, 2], T[:2, 3] - settings.centre_m
        on_ground = T[:2, 3] - forward[:2] / forward[2] * T[2, 3]
        assert np.allclose(on_ground - settings.centre_m, settings.aim * outwards)
        assert np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3))
        assert np.linalg.det(T[:3, :3]) == pytest.approx(1)


def test_recorded_positions_share_an_offset_and_have_noise_of_their_own() -> None:
    settings = GridFlightSettings(noise_m=0.5, offset_m=1.5)
    poses = fly(settings, np.random.default_rng(0))
    true = np.array([T[:3, 3] for T in poses])
    errors = np.array(
        [recorded(poses, settings, np.random.default_rng(seed)) - true for seed in range(200)]
    )
    own = errors - errors.mean(axis=1, keepdims=True)
    # 200 flights of 36 pictures: 0.7 % of the noise, 3 % of the offset.
    assert own.std() == pytest.approx(0.5 * np.sqrt(35 / 36), rel=0.03)
    assert errors.mean(axis=1).std() == pytest.approx(np.hypot(1.5, 0.5 / 6), rel=0.12)
