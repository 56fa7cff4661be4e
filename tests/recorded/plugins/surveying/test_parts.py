"""The parts of surveys: flights, errors of reconstructions, alignment, planes, depth and fusion."""

from functools import partial
from pathlib import Path

import numpy as np
import pycolmap
import pytest
from executive_plugins.surveying.camera_alignment import align_cameras
from executive_plugins.surveying.camera_positions import positions_of
from executive_plugins.surveying.depth_maps import (
    confirmed,
    make_view,
    measure_depth,
    neighbours_of,
    sweep_planes,
)
from executive_plugins.surveying.flight import take_pictures
from executive_plugins.surveying.fusion import below_flight, cells_of, fuse
from executive_plugins.surveying.grid_flight import fly, look
from executive_plugins.surveying.grid_flight import recorded as recorded_positions
from executive_plugins.surveying.photograph_folder import read_photographs
from executive_plugins.surveying.plane_sweep import View, sweep
from executive_plugins.surveying.point_cloud_file import PointCloudFile
from executive_plugins.surveying.reconstruction import own_frame, warp
from executive_plugins.surveying.settings import (
    DepthSettings,
    FlightSettings,
    GridFlightSettings,
    PointCloudFileSettings,
    ReconstructionSettings,
    SimulatedDroneSettings,
)
from executive_plugins.surveying.simulated_drone import SimulatedDrone
from executive_plugins.surveying.structure_from_motion import PosedPicture
from PIL import Image

from executive.errors import DataError
from executive.geometry.pose import inverse
from executive.interfaces.facilities import Scene


def rng(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize("cameras", [3, 4, 9])
def test_flights(recorded, cameras) -> None:
    settings = FlightSettings(cameras=cameras, low_cameras=3, rays=10)
    pictures = take_pictures(settings, lambda place: 0.1 * float(place[1]), rng(1))
    recorded([(one.position, one.rays) for one in pictures])


def test_a_picture_straight_down(recorded) -> None:
    recorded((look(np.array([0.0, 0, 9]), np.zeros(3)), look(np.zeros(3), np.array([3.0, 1, -2]))))


def test_grid_flights(recorded) -> None:
    settings = GridFlightSettings(strips=3, pictures=3)
    poses = fly(settings, rng(2))
    recorded((poses, recorded_positions(poses, settings, rng(3))))


def test_reconstruction_errors(recorded) -> None:
    settings, points = ReconstructionSettings(), rng(4).uniform(-5, 5, (30, 3))
    recorded((warp(points, settings, rng(5)), own_frame(points, settings, rng(6))))


@pytest.mark.parametrize("wrong", [0, 3])
def test_alignment(recorded, wrong) -> None:
    told = []
    for count in (4, 5, 12):
        model = rng(count).uniform(-1, 1, (count, 3)) * (3, 2, 0.5)
        rough = 2.5 * model @ np.linalg.qr(rng(1).normal(size=(3, 3)))[0].T + (1, 2, 3)
        rough += rng(2).normal(0, 0.2, rough.shape)
        rough[: wrong if count > 5 else 0] += 20.0
        found = align_cameras(model, rough, rng(3))
        told.append((found, found.apply(model[:2])))
    line = np.linspace(0, 1, 6)[:, None] * (1.0, 2, 0)
    for centres in (line, line[:3], line + np.outer([0, 1, 0, 1, 0, 1], (0.3, 0, 0))):
        try:
            told.append(align_cameras(centres, centres, rng(4)))
        except DataError as error:
            told.append(error)
    recorded(told)


def test_tables(recorded, tmp_path) -> None:
    pictures, table, told = [tmp_path / "a.jpg", tmp_path / "b.jpg"], tmp_path / "t.csv", []
    for text in (
        "name,x,y,z\na.jpg,1,2,3\nb.jpg, 3 ,2,5\n",
        "name,lat,lon,alt\na.jpg,47.4,8.5,440\n\nb.jpg,47.4001,8.5002,450\n",
        "name,lat,lon,alt\na.jpg,90,180,440\nb.jpg,-90,-180,450\n",
        "name,lat,lon,alt\na.jpg,90.1,8.5,440\nb.jpg,47,8.5,450\n",
        "name,lat,lon,alt\na.jpg,47,-180.5,440\nb.jpg,47,8.5,450\n",
        "name,x,y,z\na.jpg,1,2,3\n",
        "name,x,y,z\na.jpg,1,2\nb.jpg,1,2,3\n",
        "name,x,y,z\na.jpg,1,2,nan\nb.jpg,1,2,3\n",
        "x,y,z\n",
        "",
    ):
        table.write_text(text)
        try:
            told.append(positions_of(pictures, table))
        except DataError as error:
            told.append(str(error).replace(str(tmp_path), ""))
    recorded(told)


def tagged(path: Path, *, south: bool, below: bool, fix: bool = True) -> None:
    tags = Image.Exif()
    gps = tags.get_ifd(0x8825)
    gps[1], gps[2] = "S" if south else "N", (47.0, 24.0, 30.0)
    gps[3], gps[4] = "W" if south else "E", (8.0, 30.0, 36.0 + 3.6 * below)
    if fix:
        gps[5], gps[6] = b"\x01" if below else b"\x00", 4.5
    Image.new("RGB", (32, 24)).save(path, exif=tags)


def test_tags(recorded, tmp_path) -> None:
    told = []
    for south, fix in ((False, True), (True, True), (False, False)):
        tagged(tmp_path / "a.jpg", south=south, below=False)
        tagged(tmp_path / "b.JPG", south=south, below=True, fix=fix)
        try:
            told.append(read_photographs(tmp_path, None, 2))
        except DataError as error:
            told.append(str(error).replace(str(tmp_path), ""))
    Image.new("RGB", (24, 32)).save(tmp_path / "c.png")
    for fewest in (3, 4):
        with pytest.raises(DataError) as refused:
            read_photographs(tmp_path, None, fewest)
        told.append(str(refused.value).replace(str(tmp_path), ""))
    recorded(told)


def ground(seed: int, count: int = 400) -> np.ndarray:
    xy = rng(seed).uniform(-3, 3, (count, 2))
    high = rng(seed + 1).random(count) < 0.05
    return np.c_[xy, 0.1 * xy[:, 0] + rng(seed + 2).normal(0, 0.01, count) + 0.6 * high]


def test_planes(recorded) -> None:
    told, centres = [], rng(1).uniform(-2, 2, (5, 3)) + (0, 0, 8)
    for points, above, pixel_m in (
        (ground(2), centres, 0.022),
        (ground(3) * (1, 1, -1), centres * (1, 1, -1), 0.5),
        (ground(4)[:50], centres, 0.002),
        (np.round(ground(5) * 8) / 8, centres, 0.1),
    ):
        told.append(sweep_planes(points, above, DepthSettings(pixel_m=pixel_m)))
    with pytest.raises(DataError) as refused:
        sweep_planes(ground(4)[:49], centres, DepthSettings())
    recorded((told, refused.value))


K = np.array([[40.0, 0, 15.5], [0, 40, 11.5], [0, 0, 1]])


def texture(x, y):
    return 120 + 60 * np.sin(3 * x) * np.cos(2.5 * y) + 40 * np.sin(7 * x + 5 * y)


def seen_from(x: float, y: float, height: float = 4.0) -> View:
    """Return the picture of a textured ground with a step at x = 0.4."""
    T = inverse(look(np.array([x, y, height]), np.array([0.3 * x, 0.3 * y, 0.0])))
    blank = View(np.zeros((24, 32), np.float32), K, T)
    rays = blank.rays()
    low = blank.centre + rays * (-height / rays[..., 2:])
    step = blank.centre + rays * ((0.3 - height) / rays[..., 2:])
    on_step = step[..., 0] > 0.4
    points = np.where(on_step[..., None], step, low)
    return View(texture(points[..., 0], points[..., 1]).astype(np.float32), K, T)


VIEWS = [seen_from(0, 0), seen_from(1.0, 0), seen_from(-1.0, 0.2), seen_from(0.1, 1.1)]


@pytest.mark.parametrize("others", [1, 2, 3])
@pytest.mark.parametrize("window_px", [3, 5])
def test_sweeps(recorded, others, window_px) -> None:
    offsets = np.linspace(-0.3, 0.6, 10)
    told = sweep(VIEWS[0], VIEWS[1 : 1 + others], np.array([0.0, 0, 1]), offsets, window_px)
    # The correlation adds up in single precision.
    recorded(told, relative=1e-4, absolute=1e-4)


def test_depth_maps(recorded) -> None:
    settings = DepthSettings(least_score=0.5, window_px=4, compared=2, tolerance=0.05)
    planes = sweep_planes(
        ground(6), np.array([v.centre for v in VIEWS]), DepthSettings(pixel_m=0.1)
    )
    neighbours = [[1, 2, 3], [0, 2], [0], []]
    maps = [
        measure_depth(view, [VIEWS[j] for j in others], planes, settings)
        for view, others in zip(VIEWS, neighbours, strict=True)
    ]
    told = [
        confirmed(VIEWS[0], maps[0], [(VIEWS[j], maps[j]) for j in n], settings) for n in neighbours
    ]
    recorded((maps, [one.sum() for one in told]), relative=1e-4, absolute=1e-4)


def test_votes(recorded) -> None:
    """Depths that agree exactly up to the tolerance, beside the picture and behind it."""
    T = np.eye(4)
    view = View(np.zeros((3, 4), np.float32), np.array([[2.0, 0, 1.5], [0, 2, 1], [0, 0, 1]]), T)
    depth = np.array([[4.0, 4, 4, np.nan], [4, 5, 3.5, 4], [-4, 4, 4, 4]])
    told = []
    for factor in (1.0, 1.25, 1.5):
        settings = DepthSettings(confirmed_by=1, tolerance=0.1)
        its = np.full((3, 4), 4.0) * factor
        told.append(confirmed(view, depth, [(view, its)], settings))
    recorded(np.array(told))


def picture(name: str, centre, seen) -> PosedPicture:
    camera = pycolmap.Camera(
        model="SIMPLE_RADIAL", width=64, height=48, params=[70.0, 32.0, 24.0, 0.05]
    )
    T = inverse(look(np.array(centre), np.zeros(3)))
    return PosedPicture(name, camera, T, np.array(seen, dtype=np.int64))


def test_views(recorded, tmp_path) -> None:
    values = (rng(7).random((48, 64)) * 255).astype(np.uint8)
    Image.fromarray(values).save(tmp_path / "a.png")
    one, told = picture("a.png", (0.5, 0.2, 5.0), [0]), []
    for focal_px in (20.0, 35.0, 500.0):
        view = make_view(one, tmp_path, np.eye(4), focal_px)
        told.append((view, view.rays()[::9, ::9], view.centre))
    # The picture is thinned in single precision.
    recorded((told, one.centre), relative=1e-5)


def test_neighbours(recorded) -> None:
    points = ground(8, 60)
    pictures = [
        picture(str(k), (1.5 * k, 0.3 * k, 6.0), np.flatnonzero(rng(k).random(60) < 0.6))
        for k in range(5)
    ]
    pictures.append(picture("blind", (9.0, 9, 9), []))
    recorded([neighbours_of(pictures, points, angle, n) for angle in (0.2, 0.5) for n in (2, 9)])


def test_fusion(recorded) -> None:
    points, told = np.round(ground(9) * 16) / 16, []
    centres = np.array([[0.0, 0, 5], [2, 0, 5], [0, 2, 5], [-1, -1, 5]])
    for margin_m in (0.0, 0.5, -0.25):
        told.append(below_flight(points, centres, margin_m).sum())
    square = np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]])
    told.append(below_flight(np.array([[1.0, 1, 0], [1.5, 0.5, 0]]), square, 0.5))
    parts = [partial(cells_of, points[k::2], centres[k], 0.25) for k in range(2)]
    told += [fuse(parts, fewest) for fewest in (1, 2, 3)]
    told.append(fuse([partial(cells_of, points[:2], centres[0], 0.01)], 1))
    recorded(told)


def test_files(recorded, tmp_path) -> None:
    path, told = tmp_path / "cloud.xyz", []
    points = rng(10).integers(0, 80, (300, 3)) / 16.0 + (2_600_000, 1_200_000, 440)
    for count, limits in ((300, {}), (100, {}), (99, {}), (300, {"max_extent_m": 4.0})):
        np.savetxt(path, points[:count], fmt="%.4f")
        survey = PointCloudFile(PointCloudFileSettings(path=path, voxel_m=0.25, **limits))
        try:
            told.append(survey.survey(rng(1)))
        except DataError as error:
            told.append(str(error).replace(str(tmp_path), ""))
    recorded(told)


class Plain(Scene):
    """Level ground with a hole."""

    def cast_rays(self, origins, directions):
        with np.errstate(divide="ignore"):
            ranges = -origins[:, 2] / directions[:, 2]
        places = origins + ranges[:, None] * directions
        hole = np.linalg.norm(places[:, :2] - (3.0, 1.0), axis=1) < 1.0
        return np.where((ranges > 0) & ~hole, ranges, np.inf)


def test_a_drone(recorded) -> None:
    flight = {"cameras": 4, "rays": 20}
    drone = SimulatedDrone(SimulatedDroneSettings(flight=flight), Plain())
    told = [drone.survey(rng(11))]
    away = SimulatedDrone(SimulatedDroneSettings(flight=flight), Plain())
    away._robot = None
    with pytest.raises(DataError) as refused:
        away.survey(rng(12))
    recorded((told, refused.value))
