"""What pycolmap is asked for, and what is made of its answer, with a stand-in that keeps count."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.surveying import structure_from_motion
from executive_plugins.surveying.photograph_folder import Photographs
from executive_plugins.surveying.settings import MotionSettings
from executive_plugins.surveying.structure_from_motion import PosedPicture, find_motion
from executive_plugins.surveying.work_folder import WorkFolder

from executive.errors import DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy

NAMES = ("a b.JPG", "c.png", "d.jpeg", "e.jpg", "f.jpg")
# Along a line, and no two distances alike.
PLACES = np.array([[0.0, 0, 9], [1.0, 0, 9], [2.1, 0, 9], [3.3, 0, 9], [9.0, 0, 9]])
LINKS = ["00000.jpg", "00001.png", "00002.jpeg", "00003.jpg", "00004.jpg"]


def options(**parts: object) -> type:
    return type("Options", (), {"__init__": lambda self: vars(self).update(parts)})


class Found:
    """A model of the three pictures in the middle; the numbers of its points are not in order."""

    def __init__(self, placed=("00002.jpeg", "00001.png", "00003.jpg"), size=3) -> None:
        self.points3D = {
            70: SimpleNamespace(xyz=[7.0, 0, 0]),
            5: SimpleNamespace(xyz=[5.0, 0, 0]),
            9: SimpleNamespace(xyz=[9.0, 1, 2]),
        }
        self.cameras = {1: "camera one", 2: "camera two"}
        self.size = size
        seen = {"00001.png": (70, 5, 70), "00002.jpeg": (9,), "00003.jpg": ()}
        self.images = {
            n: SimpleNamespace(
                name=name,
                has_pose=name in placed,
                camera_id=2 if name == "00002.jpeg" else 1,
                cam_from_world=lambda n=n: SimpleNamespace(
                    matrix=lambda: pose(from_rpy(0, 0, 0.1 * n), np.array([n, 0.0, 0.0]))[:3]
                ),
                get_observation_points2D=lambda name=name: [
                    SimpleNamespace(point3D_id=i) for i in seen.get(name, ())
                ],
            )
            for n, name in enumerate(LINKS)
        }

    def num_reg_images(self) -> int:
        return self.size

    def write(self, folder: Path) -> None:
        (folder / "model").write_text(str(self.size))


class Colmap:
    """Keeps what it is asked for."""

    FeatureExtractionOptions = options(sift=SimpleNamespace())
    ImageReaderOptions = options(camera_params="")
    FeatureMatchingOptions = options()
    ImportedPairingOptions = options()
    TwoViewGeometryOptions = options(ransac=SimpleNamespace())
    IncrementalPipelineOptions = options(mapper=SimpleNamespace(), triangulation=SimpleNamespace())
    CameraMode, Device = SimpleNamespace(SINGLE="single"), SimpleNamespace(cpu="cpu")

    def __init__(self, models: dict[int, Found], read: Found | None = None) -> None:
        self.models, self.asked = models, SimpleNamespace()
        self._read = read or Found()

    def set_random_seed(self, seed: int) -> None:
        self.asked.seed = seed

    def extract_features(self, database, pictures, links, mode, reader, asked, device) -> None:
        self.asked.features = SimpleNamespace(
            links=links, mode=mode, reader=reader, options=asked, device=device
        )
        self.asked.targets = [str((pictures / link).resolve().name) for link in links]
        self.asked.database = database

    def match_image_pairs(self, database, asked, pairing, geometry, device) -> None:
        assert database == self.asked.database
        self.asked.matches = SimpleNamespace(options=asked, geometry=geometry, device=device)
        self.asked.pairs = pairing.match_list_path.read_text().split("\n")

    def incremental_mapping(self, database, pictures, out, asked) -> dict[int, Found]:
        assert (database, out) == (self.asked.database, database.parent)
        self.asked.mapping = asked
        return self.models

    def Reconstruction(self, folder: Path) -> Found:
        self.asked.read = (folder / "model").read_text()
        return self._read


@pytest.fixture
def photographs(tmp_path: Path) -> Photographs:
    folder = tmp_path / "pictures"
    folder.mkdir()
    for name in NAMES:
        (folder / name).touch()
    return Photographs(folder, NAMES, PLACES, (400, 300))


@pytest.fixture
def find(photographs, tmp_path, monkeypatch):
    def find(colmap: Colmap, **settings: object):
        monkeypatch.setattr(structure_from_motion, "load_pycolmap", lambda: colmap)
        known = {"neighbours": 3, "least_registered": 0.6} | settings
        return find_motion(photographs, MotionSettings(**known), 11, WorkFolder(tmp_path))

    return find


def test_equal_pictures_give_an_equal_model_without_a_graphics_card(find) -> None:
    colmap = Colmap({0: Found()})
    find(colmap, feature_px=800, features=900)
    asked = colmap.asked
    assert (asked.seed, asked.targets) == (11, list(NAMES))
    assert (asked.features.links, asked.features.mode) == (LINKS, "single")
    assert asked.features.reader.camera_params == ""
    own = vars(asked.features.options)
    assert (own["num_threads"], own["use_gpu"], own["max_image_size"]) == (1, False, 800)
    assert vars(own["sift"]) == {"max_num_features": 900, "first_octave": 0}
    assert vars(asked.matches.options) == {"num_threads": 1, "use_gpu": False}
    assert vars(asked.matches.geometry.ransac) == {"random_seed": 11}
    assert asked.features.device == asked.matches.device == "cpu"
    mapping = vars(asked.mapping)
    assert (mapping["multiple_models"], mapping["extract_colors"]) == (False, False)
    assert (mapping["num_threads"], mapping["random_seed"]) == (1, 11)
    assert mapping["min_model_size"] == 3
    assert vars(mapping["mapper"]) == {"num_threads": 1, "random_seed": 11}
    assert vars(mapping["triangulation"]) == {"random_seed": 11}


def test_each_picture_is_matched_with_its_nearest_once(find) -> None:
    colmap = Colmap({0: Found()})
    find(colmap)
    # The nearest three of the last are 3, 2 and 1; of the first 1, 2 and 3.
    pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (1, 4), (2, 3), (2, 4), (3, 4)]
    assert colmap.asked.pairs == [f"{LINKS[i]} {LINKS[j]}" for i, j in pairs]


def test_a_known_camera_begins_the_adjustment(find) -> None:
    colmap = Colmap({0: Found()})
    find(colmap, view_angle_rad=2 * np.arctan(0.5))
    focal, *rest = map(float, colmap.asked.features.reader.camera_params.split(","))
    assert focal == pytest.approx(400.0)  # half of the width over the tangent of half the angle
    assert rest == [200.0, 150.0, 0.0]


def test_the_largest_model_is_kept_and_read_again(find) -> None:
    colmap = Colmap({0: Found(size=3), 1: Found(size=5), 2: Found(size=4)})
    find(colmap)
    assert colmap.asked.read == "5"
    again = Colmap({})
    find(again)  # nothing is solved for anew
    assert vars(again.asked) == {"read": "5"}


def test_the_model_has_its_pictures_by_name_and_its_points_in_order(find) -> None:
    model = find(Colmap({0: Found()}))
    assert model.points.tolist() == [[5.0, 0, 0], [9.0, 1, 2], [7.0, 0, 0]]
    assert [one.name for one in model.pictures] == ["c.png", "d.jpeg", "e.jpg"]
    assert [one.camera for one in model.pictures] == ["camera one", "camera two", "camera one"]
    assert [one.seen.tolist() for one in model.pictures] == [[0, 2], [1], []]
    T = model.pictures[1].T_optical_model
    assert pytest.approx(pose(from_rpy(0, 0, 0.2), np.array([2.0, 0.0, 0.0]))) == T


def test_a_camera_is_where_its_pose_says() -> None:
    T = pose(from_rpy(0.3, -0.2, 1.0), np.array([1.0, 2.0, 3.0]))
    centre = PosedPicture("a", None, T, np.zeros(0, dtype=np.int64)).centre
    assert T @ [*centre, 1.0] == pytest.approx([0.0, 0.0, 0.0, 1.0])


def test_too_few_pictures_in_place_are_told_by_name(find) -> None:
    """Three of five are enough if that is the share that is wanted, and no more."""
    with pytest.raises(DataError) as refused:
        find(Colmap({0: Found()}), least_registered=0.61)
    told = str(refused.value)
    assert "3 of 5 pictures found their place, at least 61% are wanted" in told
    assert "lost: a b.JPG, f.jpg. Fly" in told


def test_without_any_model_all_pictures_are_lost(find, photographs, tmp_path) -> None:
    with pytest.raises(DataError, match=r"0 of 5 .* lost: a b\.JPG, c\.png, .*, f\.jpg\. Fly"):
        find(Colmap({}))
