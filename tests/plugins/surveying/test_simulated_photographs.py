"""What a simulated drone brings home: pictures with their rough focal length, and a table."""

from pathlib import Path

import numpy as np
import pytest
from executive_plugins.surveying import colmap, simulated_photographs
from executive_plugins.surveying.settings import (
    ColmapSettings,
    GridFlightSettings,
    SimulatedPhotographsSettings,
)
from executive_plugins.surveying.simulated_photographs import SimulatedPhotographs, take_photographs
from PIL import Image

from executive.errors import ConfigError
from executive.extras import MissingExtraError
from executive.interfaces.facilities import Photographer, SurveyedElsewhere
from executive.messages.cloud import Cloud

FLIGHT = GridFlightSettings(strips=2, pictures=3, size_px=(320, 240), offset_m=0.0, noise_m=0.0)


class Camera(Photographer):
    """Draws a picture of one grey for each pose, brighter from one to the next."""

    def photograph(self, T_world_opticals, size_px, view_angle_rad):
        self.asked = size_px, view_angle_rad
        for i in range(len(T_world_opticals)):
            yield np.full((size_px[1], size_px[0], 3), 20 * i, np.uint8)


class Remote(SurveyedElsewhere):
    """A machine in another process, with the seed that it was asked with."""

    def survey_of_site(self, seed: int) -> Cloud:
        self.seed = seed
        return Cloud("survey", np.zeros((1, 3)))


def test_the_pictures_are_in_the_order_of_the_poses_with_their_focal_length(
    tmp_path: Path,
) -> None:
    camera = Camera()
    poses = take_photographs(camera, FLIGHT, tmp_path, np.random.default_rng(1))
    assert camera.asked == (FLIGHT.size_px, FLIGHT.view_angle_rad)
    names = [f"photograph_{n}.jpg" for n in ("001", "002", "003", "004", "005", "006")]
    assert sorted(path.name for path in tmp_path.glob("*.jpg")) == names
    # A film is 36 mm wide: half of it is the focal length times the tangent of half the view.
    focal_mm = 18 / np.tan(FLIGHT.view_angle_rad / 2)
    for i, name in enumerate(names):
        with Image.open(tmp_path / name) as picture:
            assert picture.size == FLIGHT.size_px
            assert abs(np.asarray(picture, float).mean() - 20 * i) < 2
            assert abs(picture.getexif().get_ifd(0x8769)[0xA405] - focal_mm) <= 0.5
    (table,) = set(tmp_path.iterdir()) - {tmp_path / name for name in names}
    header, *rows = table.read_text(encoding="utf-8").splitlines()
    assert header == "name,x,y,z"
    assert [row.split(",")[0] for row in rows] == names
    places = np.array([row.split(",")[1:] for row in rows], float)
    np.testing.assert_allclose(places, np.array(poses)[:, :3, 3], atol=0.00051)  # millimetres


def survey(monkeypatch, folder: Path | None) -> list[Path]:
    """Survey with a reconstruction that only looks where the pictures lie."""
    seen: list[Path] = []

    def read(found: Path, *_: object) -> None:
        assert len(list(found.glob("*.jpg"))) == 6
        seen.append(found)

    class Made:
        cloud = Cloud("survey", np.zeros((1, 3)))

    monkeypatch.setattr(simulated_photographs, "read_photographs", read)
    monkeypatch.setattr(simulated_photographs, "reconstruct", lambda *_: Made)
    settings = SimulatedPhotographsSettings.model_validate({"flight": FLIGHT, "folder": folder})
    made = SimulatedPhotographs(settings, Camera()).survey(np.random.default_rng(0))  # type: ignore[arg-type]
    assert made is Made.cloud
    return seen


def test_pictures_that_nobody_keeps_are_removed(monkeypatch) -> None:
    (folder,) = survey(monkeypatch, None)
    assert not folder.exists()


@pytest.mark.parametrize("is_there", [False, True])
def test_pictures_are_kept_in_a_new_or_an_empty_folder(monkeypatch, tmp_path, is_there) -> None:
    kept = tmp_path / "a" / "b"
    if is_there:
        kept.mkdir(parents=True)
    assert survey(monkeypatch, kept) == [kept]
    assert len(list(kept.glob("*.jpg"))) == 6


@pytest.mark.parametrize("is_file", [False, True])
def test_nothing_is_written_over(monkeypatch, tmp_path, is_file) -> None:
    kept = tmp_path / "kept"
    if is_file:
        kept.write_text("mine")
    else:
        kept.mkdir()
        (kept / "mine.txt").write_text("mine")
    with pytest.raises(ConfigError, match=r"surveying\.folder: .*kept is there already"):
        survey(monkeypatch, kept)
    assert (kept if is_file else kept / "mine.txt").read_text() == "mine"


def test_a_machine_in_another_process_makes_the_survey_itself() -> None:
    remote = Remote()
    drone = SimulatedPhotographs(SimulatedPhotographsSettings(), remote)  # type: ignore[arg-type]
    assert drone.is_remote
    drone.start()  # without what makes clouds of pictures
    assert drone.survey(np.random.default_rng(4)).frame == "survey"
    assert remote.seed == np.random.default_rng(4).integers(2**31)


def test_a_robot_without_a_site_is_refused_at_the_start(monkeypatch) -> None:
    monkeypatch.setattr(simulated_photographs, "load_pycolmap", lambda: None)
    drone = SimulatedPhotographs(SimulatedPhotographsSettings(), object())  # type: ignore[arg-type]
    assert not drone.is_remote
    with pytest.raises(ConfigError, match="the robot object has none; use colmap"):
        drone.start()
    SimulatedPhotographs(SimulatedPhotographsSettings(), Camera()).start()  # type: ignore[arg-type]


def test_what_makes_clouds_of_pictures_is_looked_for_at_the_start(monkeypatch, tmp_path) -> None:
    """Not at the survey, when the machine stands at the site already."""

    def missing() -> None:
        raise MissingExtraError("structure from motion", "photogrammetry", ("pycolmap",), "x")

    monkeypatch.setattr(simulated_photographs, "load_pycolmap", missing)
    monkeypatch.setattr(colmap, "load_pycolmap", missing)
    drone = SimulatedPhotographs(SimulatedPhotographsSettings(), Camera())  # type: ignore[arg-type]
    real = colmap.Colmap(ColmapSettings(photographs=tmp_path))
    for survey_plugin in (drone, real):
        with pytest.raises(MissingExtraError, match="pycolmap"):
            survey_plugin.start()
