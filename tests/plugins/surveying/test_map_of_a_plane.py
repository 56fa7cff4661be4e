"""A cloud from six small pictures of level ground whose places are known: where the ground is, what
is told on the way, and what is refused.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from executive_plugins.surveying import photogrammetry
from executive_plugins.surveying.colmap import Colmap
from executive_plugins.surveying.grid_flight import look
from executive_plugins.surveying.photogrammetry import reconstruct
from executive_plugins.surveying.photograph_folder import Photographs
from executive_plugins.surveying.settings import ColmapSettings, PhotogrammetrySettings
from executive_plugins.surveying.structure_from_motion import Model, PosedPicture
from executive_plugins.surveying.work_folder import WorkFolder
from PIL import Image
from scipy.ndimage import gaussian_filter, map_coordinates

from executive.arrays import Float
from executive.clouds.reader import read_cloud
from executive.commands.main import main
from executive.errors import DataError
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy

TEXTURE = gaussian_filter(np.random.default_rng(0).normal(size=(400, 400)), 1.5)
TEXTURE = 128 + 40 * TEXTURE / TEXTURE.std()
SIZE, FOCAL_PX, CELL_M = (96, 72), 90.0, 0.03
# The model is half as large as the site, turned and shifted: p_survey = 2 R p_model + t.
SCALE, R, SHIFT = 2.0, from_rpy(0.1, -0.2, 0.5), np.array([1.0, 2.0, -1.0])
PLACES = np.array([[x, y, 4.0 + 0.1 * x * y] for y in (-0.6, 0.6) for x in (-1.0, 0.0, 1.0)])


@dataclass(frozen=True)
class Pinhole:
    """A camera without distortion, whose pixels are counted from the corner of the first."""

    width: int = SIZE[0]
    height: int = SIZE[1]

    def mean_focal_length(self) -> float:
        return FOCAL_PX

    def img_from_cam(self, points_optical: Float) -> Float:
        uv = FOCAL_PX * points_optical[:, :2] / points_optical[:, 2:]
        return np.asarray(uv + np.array(SIZE) / 2)


def picture(T_survey_optical: Float) -> Image.Image:
    """Return what a camera sees of the ground z = 0 m."""
    u, v = np.meshgrid(*(np.arange(n) + 0.5 - n / 2 for n in SIZE))
    rays = np.stack([u, v, np.full(u.shape, FOCAL_PX)], axis=-1) @ T_survey_optical[:3, :3].T
    ground = T_survey_optical[:3, 3] - rays * (T_survey_optical[2, 3] / rays[..., 2:])
    cells = ground[..., :2] / CELL_M + 200
    grey = map_coordinates(TEXTURE, [cells[..., 0], cells[..., 1]], order=1)
    return Image.fromarray(grey.clip(0, 255).astype(np.uint8))


def scene(folder: Path) -> tuple[Photographs, Model]:
    """Write pictures to a folder; return them, and their places in the frame of a model."""
    points = np.random.default_rng(1).uniform(-2, 2, (80, 3)) * [1, 1, 0]
    posed, names = [], tuple(f"{i}.png" for i in range(len(PLACES)))
    for name, place in zip(names, PLACES, strict=True):
        T = look(place, place * [0.3, 0.3, 0.0])
        picture(T).save(folder / name)
        R_optical_model = inverse(T)[:3, :3] @ R
        centre_model = R.T @ (place - SHIFT) / SCALE
        T_optical_model = pose(R_optical_model, -R_optical_model @ centre_model)
        posed.append(PosedPicture(name, Pinhole(), T_optical_model, np.arange(len(points))))
    model = Model(tuple(posed), (points - SHIFT) @ R / SCALE)
    return Photographs(folder, names, PLACES, SIZE), model


SETTINGS = PhotogrammetrySettings.model_validate(
    {"depth": {"pixel_m": 0.05, "above_m": 0.29, "threads": 1}, "voxel_m": 0.1}
)


@pytest.fixture
def site(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[], tuple[Photographs, Model]]:
    """Return a function that makes the scene; its model is what structure from motion finds."""

    def made() -> tuple[Photographs, Model]:
        folder = tmp_path / "pictures"
        folder.mkdir()
        photographs, model = scene(folder)
        monkeypatch.setattr(photogrammetry, "find_motion", lambda *_: model)
        return photographs, model

    return made


def test_the_ground_is_where_it_is_and_each_step_is_told(site: Callable) -> None:
    photographs, _ = site()
    told: list[str] = []
    found = reconstruct(photographs, SETTINGS, np.random.default_rng(1), told.append)
    assert found.cloud.frame == "survey"
    assert found.pictures == 6
    assert found.names == photographs.names
    np.testing.assert_allclose(found.centres_m, PLACES, atol=1e-9)
    assert found.alignment.scale == pytest.approx(SCALE)
    points = found.cloud.points
    # Half of a pixel's parallax between views 1.2 m apart is 8 cm of depth.
    assert np.abs(points[:, 2]).max() < 0.1
    assert abs(np.median(points[:, 2])) < 0.015
    assert np.median(found.cloud.normals[:, 2]) > 0.98
    # Cells of a tenth of a metre below the outline of the cameras, 2 m by 1.2 m.
    assert (np.abs(points[:, :2]) <= [1.0, 0.6]).all()
    assert 240 < len(points) < 480  # one or two above each other
    planes = told[3].split(": ")[1]
    assert told == [
        "6 pictures: features, matches and places",
        "6 of 6 pictures in place",
        "pictures read: 6 of 6",
        *(f"depth of picture {i} of 6: {planes}" for i in range(1, 7)),
        "points of pictures confirmed: 6 of 6",
    ]
    # From 0.2 m below to 0.29 m above the ground by 1.25 pixels of 5 cm, and the first.
    assert planes == "9 planes"


def test_progress_is_told_each_ten_pictures(
    site: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(photogrammetry, "_TOLD", 2)
    photographs, _ = site()
    told: list[str] = []
    reconstruct(photographs, SETTINGS, np.random.default_rng(1), told.append)
    read = [line for line in told if line.startswith("pictures read")]
    assert read == [f"pictures read: {i} of 6" for i in (2, 4, 6)]


def test_ground_beyond_the_outline_is_kept_on_request(site: Callable) -> None:
    photographs, _ = site()
    wide = SETTINGS.model_copy(update={"margin_m": 0.4})
    points = reconstruct(photographs, wide, np.random.default_rng(1)).cloud.points
    assert 1.2 < np.abs(points[:, 0]).max() <= 1.4


def test_what_no_other_picture_confirms_is_no_point(site: Callable) -> None:
    photographs, _ = site()
    depth = SETTINGS.depth.model_copy(update={"confirmed_by": 6})  # of five others
    strict = SETTINGS.model_copy(update={"depth": depth})
    with pytest.raises(DataError, match=r"no point is confirmed by 6 pictures; overlap more"):
        reconstruct(photographs, strict, np.random.default_rng(1))


def test_positions_that_leave_the_scale_open_are_refused_with_their_error(site: Callable) -> None:
    photographs, _ = site()
    rough = Photographs(
        photographs.folder,
        photographs.names,
        PLACES + np.random.default_rng(3).normal(0, 0.5, PLACES.shape),
        SIZE,
    )
    with pytest.raises(DataError, match=r"positions are 0\.\d\d m off.*allowed is 5\.0%; fly"):
        reconstruct(rough, SETTINGS, np.random.default_rng(1))


@pytest.mark.parametrize(("changed", "left"), [("nothing", 4), ("picture", 6), ("positions", 6)])
def test_work_that_was_cut_off_goes_on_unless_what_it_depends_on_changed(
    site: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, changed: str, left: int
) -> None:
    photographs, _ = site()
    work, measure, made = tmp_path / "work", photogrammetry.measure_depth, [0]
    most = 2

    def cut_off(*given: Any) -> Float:
        if made[0] == most:
            raise KeyboardInterrupt
        made[0] += 1
        return measure(*given)

    monkeypatch.setattr(photogrammetry, "measure_depth", cut_off)
    with pytest.raises(KeyboardInterrupt):
        reconstruct(photographs, SETTINGS, np.random.default_rng(1), kept=work)
    done = sorted(one.name for one in work.glob("depth_*.npy"))
    assert done == ["depth_00000.npy", "depth_00001.npy"]
    if changed == "picture":
        (photographs.folder / "3.png").touch()
    if changed == "positions":
        photographs = replace(photographs, positions_m=PLACES + 0.5)
    most, made[0] = 100, 0
    depth = SETTINGS.depth.model_copy(update={"threads": 2})  # changes no result
    threaded = SETTINGS.model_copy(update={"depth": depth})
    reconstruct(photographs, threaded, np.random.default_rng(1), kept=work)
    assert made[0] == left
    assert not work.exists()


def test_colmap_accounts_for_its_survey(site: Callable, monkeypatch: pytest.MonkeyPatch) -> None:
    photographs, model = site()
    lines = [f"{n},{x},{y},{z}" for n, (x, y, z) in zip(photographs.names, PLACES, strict=True)]
    (photographs.folder / "positions.csv").write_text("\n".join(["name,x,y,z", *lines]))
    kept: list[tuple[object, WorkFolder]] = []

    def find(pictures: Photographs, settings: object, seed: int, work: WorkFolder) -> Model:
        kept.append((settings, work))
        assert pictures.names == photographs.names
        return model

    monkeypatch.setattr(photogrammetry, "find_motion", find)
    settings = ColmapSettings.model_validate(
        {**SETTINGS.model_dump(), "photographs": photographs.folder}
    )
    survey, told = Colmap(settings), list[str]()
    survey.start()
    mean = dict(zip(("origin_x_m", "origin_y_m", "origin_z_m"), PLACES.mean(axis=0), strict=True))
    assert survey.account() == pytest.approx(mean)
    survey.follow(told.append)
    cloud = survey.survey(np.random.default_rng(1))
    assert len(cloud) > 240
    assert len(told) == 10
    account = survey.account()
    assert account["pictures"] == 6
    assert account["placed"] == photographs.names
    assert account["positions_used"] == 6
    assert account["positions_rms_m"] == pytest.approx(0, abs=1e-9)
    assert account["scale_error"] == pytest.approx(0, abs=1e-9)
    assert kept[0][0] == SETTINGS.motion
    (photographs.folder / "5.png").unlink()
    with pytest.raises(DataError, match=r"5 pictures .* at least 6"):
        survey.start()


def surveyed(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    """Run `executive survey` in this process and return its status."""
    options = ["--set", "surveying.plugin=colmap"]
    monkeypatch.setattr(sys, "argv", ["executive", "survey", *map(str, words), *options])
    try:
        main()
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0


def test_the_verb_keeps_national_coordinates_and_names_them(
    site: Callable,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    photographs, model = site()
    folder = photographs.folder
    table, out = folder / "positions.csv", folder / "cloud.laz"
    monkeypatch.setattr(photogrammetry, "find_motion", lambda *_: model)
    national = np.array([2_600_000.0, 1_200_000.0, 440.0])
    found: dict[str, np.ndarray] = {}
    for name, places in (("local", PLACES), ("national", PLACES + national)):
        rows = [f"{n},{x},{y},{z}" for n, (x, y, z) in zip(photographs.names, places, strict=True)]
        table.write_text("\n".join(["name,x,y,z", *rows]))
        assert surveyed(monkeypatch, folder, "--out", out, "--crs", "EPSG:2056", "--json") == 0
        answer = json.loads(capsys.readouterr().out)
        assert answer["crs"] == "EPSG:2056"
        assert answer["origin_x_m"] == pytest.approx(places[:, 0].mean())
        cloud = read_cloud(out)
        assert cloud.place.crs == "EPSG:2056"
        found[name] = cloud.points
    lows = [found[name].min(axis=0) for name in ("local", "national")]
    # The file's step is 0.1 mm; the positions about their mean differ by rounding.
    np.testing.assert_allclose(lows[1] - lows[0], national, rtol=0, atol=1e-3)
    degrees = [f"{n},47.{i},8.{i},400" for i, n in enumerate(photographs.names)]
    table.write_text("\n".join(["name,lat,lon,alt", *degrees]))
    assert surveyed(monkeypatch, folder, "--out", out, "--crs", "EPSG:2056") == 2
    assert "nothing is projected: give them in EPSG:2056" in capsys.readouterr().err
