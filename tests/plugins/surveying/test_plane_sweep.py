"""Planes and a step of known depth, drawn analytically from several cameras, are measured where
they are.
"""

from functools import partial
from pathlib import Path

import numpy as np
import pycolmap
import pytest
from executive_plugins.surveying import plane_sweep
from executive_plugins.surveying.depth_maps import confirmed, make_view, sweep_planes
from executive_plugins.surveying.fusion import below_flight, cells_of, fuse
from executive_plugins.surveying.grid_flight import look
from executive_plugins.surveying.plane_sweep import View, sweep
from executive_plugins.surveying.settings import DepthSettings
from executive_plugins.surveying.structure_from_motion import PosedPicture
from PIL import Image
from scipy.ndimage import gaussian_filter, map_coordinates, zoom

from executive.errors import DataError
from executive.geometry.pose import inverse

UP = np.array([0.0, 0.0, 1.0])
CELL_M = 0.02
K = np.array([[150.0, 0, 79.5], [0, 150.0, 59.5], [0, 0, 1]])
TEXTURE = gaussian_filter(np.random.default_rng(0).normal(size=(600, 600)), 1.5)
TEXTURE = 128 + 40 * TEXTURE / TEXTURE.std()


def heights(xy: np.ndarray, step_m: float) -> np.ndarray:
    """Return the ground's height: a block of step_m on x and y within half a metre, else none."""
    return np.where((np.abs(xy) < 0.5).all(axis=-1), step_m, 0.0)


def drawn(position: list[float], aim: list[float], step_m: float = 0.0, gain: float = 1.0) -> View:
    """Return the view of a camera: where each ray meets the block's top or the ground, and the
    texture there.
    """
    T = look(np.array(position), np.array(aim))
    view = View(np.zeros((120, 160), dtype=np.float32), K, inverse(T))
    rays = view.rays()
    top = view.centre + rays * ((step_m - view.centre[2]) / rays[..., 2])[..., None]
    low = view.centre + rays * (-view.centre[2] / rays[..., 2])[..., None]
    seen = np.where((heights(top[..., :2], step_m) == step_m)[..., None], top, low)
    cells = seen[..., :2] / CELL_M + 300
    grey = map_coordinates(TEXTURE, [cells[..., 0], cells[..., 1]], order=1)
    return View((gain * grey).astype(np.float32), K, inverse(T))


def around(step_m: float = 0.0, tilt_m: float = 0.0) -> list[View]:
    places = [
        [0.0, 0.05, 4.0],
        [1.2, 0.0, 4.0],
        [-1.2, 0.1, 4.2],
        [0.1, 1.2, 3.9],
        [0.0, -1.2, 4.1],
    ]
    return [drawn(place, [tilt_m, 0.0, 0.0], step_m, 1 + 0.1 * i) for i, place in enumerate(places)]


def enlarged(view: View) -> View:
    """Return the view in four pixels for each."""
    grey = zoom(view.grey, 2, order=1, mode="nearest", grid_mode=True)
    K = view.K.copy()
    K[:2] *= 2
    K[:2, 2] += 0.5
    return View(grey, K, view.T_optical_world)


def points_of(view: View, depth: np.ndarray) -> np.ndarray:
    return np.asarray(view.centre + view.rays() * depth[..., None])


@pytest.mark.parametrize("tilt_m", [0.0, 1.5])
def test_measures_a_plane_between_the_planes_of_the_sweep(tilt_m: float) -> None:
    views = around(tilt_m=tilt_m)
    offsets = np.linspace(-0.32, 0.28, 21)  # none of them is the ground
    depth, score = sweep(views[0], views[1:], UP, offsets, 5)
    z = points_of(views[0], depth)[..., 2]
    found = np.isfinite(z) & (score > 0.6)
    assert found.mean() > 0.7
    # A tenth of a pixel of 27 mm between views 17° apart is 9 mm.
    assert np.median(np.abs(z[found])) < 0.006
    assert np.percentile(np.abs(z[found]), 95) < 0.02
    assert abs(np.median(z[found])) < 0.002


def test_sees_a_block_and_the_ground_beside_it() -> None:
    views = around(step_m=0.4)
    depth, score = sweep(views[0], views[1:], UP, np.linspace(-0.2, 0.6, 28), 5)
    seen = points_of(views[0], depth)
    off_edge = (
        np.abs(np.abs(seen[..., :2]).max(axis=-1) - 0.5) > 0.12
    )  # windows that do not straddle it
    found = np.isfinite(depth) & (score > 0.6) & off_edge
    error = np.abs(seen[..., 2] - heights(seen[..., :2], 0.4))[found]
    on_top = (np.abs(seen[..., :2]) < 0.38).all(axis=-1) & found
    assert on_top.sum() > 300
    assert np.median(error) < 0.006
    assert np.percentile(error, 95) < 0.04


def test_planes_that_small_pictures_choose_are_those_of_a_sweep_through_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    views = [enlarged(view) for view in around(step_m=0.4)]
    offsets = np.linspace(-0.5, 1.5, 81)
    chosen, score = sweep(views[0], views[1:], UP, offsets, 5)
    monkeypatch.setattr(plane_sweep, "_MANY_PLANES", 1000)
    through_all, its_score = sweep(views[0], views[1:], UP, offsets, 5)
    sure = np.isfinite(through_all) & (its_score > 0.6)
    assert sure.mean() > 0.5
    assert (np.abs(chosen - through_all)[sure] < 1e-3).mean() > 0.99
    wrong = np.isfinite(chosen) & (score > 0.6) & ~sure
    assert wrong.mean() < 0.01


def test_a_tile_is_compared_near_what_was_found_and_on_all_planes_where_nothing_was() -> None:
    found = np.full((64, 32), -1.0, dtype=np.float32)
    found[:20] = 30.0
    found[5, 5] = 40.5
    ranges = plane_sweep._near(found, (4, 2), 100)
    assert ranges[0].tolist() == [[26, 45], [26, 34]]
    assert ranges[3].tolist() == [[0, 99], [0, 99]]
    assert plane_sweep._near(found - 29, (4, 2), 10)[0, 1].tolist() == [0, 5]


def test_believes_nothing_where_there_is_no_contrast() -> None:
    views = [View(np.full_like(view.grey, 90), view.K, view.T_optical_world) for view in around()]
    depth, score = sweep(views[0], views[1:], UP, np.linspace(-0.3, 0.3, 11), 5)
    assert np.isnan(depth).all()
    assert (score == -1).all()


def test_gives_no_depth_where_the_surface_is_beyond_the_sweep() -> None:
    views = around()
    depth, score = sweep(views[0], views[1:], UP, np.linspace(0.3, 0.8, 18), 5)
    believed = np.isfinite(depth) & (score > 0.8)
    assert believed.mean() < 0.02


def test_other_depth_maps_confirm_what_is_there_and_not_what_is_not() -> None:
    views = around()
    truth = [(-view.centre[2] / view.rays()[..., 2]) for view in views]
    others = list(zip(views[1:], truth[1:], strict=True))
    settings = DepthSettings(confirmed_by=2, tolerance=0.004)
    assert confirmed(views[0], truth[0], others, settings)[30:90, 40:120].all()
    assert not confirmed(views[0], truth[0] * 1.02, others, settings).any()
    assert not confirmed(views[0], np.full((120, 160), np.nan), others, settings).any()
    none = [(view, np.full((120, 160), np.nan)) for view in views[1:]]
    assert not confirmed(views[0], truth[0], none, settings).any()


def test_planes_lie_along_the_ground_and_span_the_stones() -> None:
    rng = np.random.default_rng(0)
    slope = np.array([0.2, -0.1, 1.0]) / np.linalg.norm([0.2, -0.1, 1.0])
    across = np.linalg.svd(slope[None])[2][1:]
    flat = rng.uniform(-8, 8, (3000, 2)) @ across + rng.normal(0, 0.02, (3000, 1)) * slope
    stones = rng.uniform(-2, 2, (60, 2)) @ across + rng.uniform(0, 0.9, (60, 1)) * slope
    cameras = rng.uniform(-6, 6, (20, 2)) @ across + 8 * slope
    planes = sweep_planes(np.vstack([flat, stones]), cameras, DepthSettings())
    assert np.degrees(np.arccos(planes.normal @ slope)) < 0.2
    assert planes.offsets_m[0] < -0.2
    assert 1.2 < planes.offsets_m[-1] < 1.6
    assert planes.distance_m == pytest.approx(8, abs=0.05)


def test_fusion_means_cells_drops_lone_points_and_turns_normals_to_the_cameras() -> None:
    rng = np.random.default_rng(0)
    flat = np.column_stack([rng.uniform(0, 1, (4000, 2)), np.full(4000, 0.05)])
    lone = np.array([[0.5, 0.5, 3.0]])
    above, below = np.array([0.5, 0.5, 5.0]), np.array([0.5, 0.5, -5.0])
    first, second, other = (
        partial(cells_of, seen, camera, 0.1)
        for seen, camera in ((flat, above), (np.vstack([flat, lone]), above), (flat, below))
    )
    points, normals = fuse([first, second], 2)
    assert len(points) == 100
    assert np.allclose(points[:, 2], 0.05)
    assert np.allclose(normals, UP, atol=1e-6)
    assert np.allclose(fuse([other], 1)[1], -UP, atol=1e-6)


def test_keeps_what_lies_below_the_flight() -> None:
    cameras = np.array([[0.0, 0, 8], [4, 0, 8], [4, 6, 8], [0, 6, 8], [2, 3, 9]])
    points = np.array([[2.0, 3, 0], [-0.4, 3, 0], [5, 3, 0], [4.4, 6.4, 1]])
    assert below_flight(points, cameras, 0.0).tolist() == [True, False, False, False]
    assert below_flight(points, cameras, 0.5).tolist() == [True, True, False, True]


def test_a_view_has_no_lens_distortion_and_the_pixels_of_its_size(tmp_path: Path) -> None:
    """A straight edge that a lens has bent is straight again, where the pinhole would see it."""
    camera = pycolmap.Camera.create_from_model_name(1, "SIMPLE_RADIAL", 400.0, 480, 360)
    camera.params = [400.0, 240.0, 180.0, -0.15]
    u, v = np.meshgrid(np.arange(480) + 0.5, np.arange(360) + 0.5)
    straight = np.array(camera.cam_from_img(np.stack([u.ravel(), v.ravel()], axis=1)))
    bright = (straight[:, 0] > 0.4).reshape(
        360, 480
    )  # all that is right of x = 0.4 z in the pinhole's view
    Image.fromarray((200 * bright).astype(np.uint8)).save(tmp_path / "edge.png")
    picture = PosedPicture("edge.png", camera, np.eye(4), np.arange(3))
    view = make_view(picture, tmp_path, np.eye(4), 200.0)
    assert view.grey.shape == (180, 240)
    edge = 0.4 * view.K[0, 0] + view.K[0, 2]
    for row in view.grey[20:160]:
        assert np.interp(100, row[150:], np.arange(150, 240)) == pytest.approx(
            edge, abs=0.5
        )  # half a pixel


def test_names_a_picture_that_is_cut_short_or_turned(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (60, 80, 3), dtype=np.uint8)
    Image.fromarray(noise).save(tmp_path / "a.jpg")
    camera = pycolmap.Camera.create_from_model_name(1, "SIMPLE_RADIAL", 80.0, 80, 60)
    picture = PosedPicture("a.jpg", camera, np.eye(4), np.arange(3))
    whole = (tmp_path / "a.jpg").read_bytes()
    (tmp_path / "a.jpg").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DataError, match=r"a.jpg: cannot be read whole"):
        make_view(picture, tmp_path, np.eye(4), 80.0)
    Image.fromarray(noise.transpose(1, 0, 2)).save(tmp_path / "a.jpg")
    with pytest.raises(DataError, match=r"a.jpg: is turned by its tags"):
        make_view(picture, tmp_path, np.eye(4), 80.0)


def middle(view: View, side: int) -> View:
    """Return the square in the middle of a view."""
    top, left = (length // 2 - side // 2 for length in view.grey.shape)
    K = view.K - [[0, 0, left], [0, 0, top], [0, 0, 0]]
    grey = view.grey[top : top + side, left : left + side].copy()
    return View(grey, K, view.T_optical_world)


def test_a_halved_view_sees_what_four_pixels_saw() -> None:
    """The middle of the four, on the same ray; a last odd row and column are left out."""
    grey = np.arange(35.0, dtype=np.float32).reshape(5, 7)
    view = View(grey, K, np.eye(4))
    half = plane_sweep._halved(view)
    np.testing.assert_array_equal(half.grey, [[4.0, 6.0, 8.0], [18.0, 20.0, 22.0]])
    four = view.rays()[2:4, 4:6].reshape(4, 3).mean(axis=0)
    np.testing.assert_allclose(half.rays()[1, 2], four, atol=1e-12)
    assert view.K[0, 0] == 150.0


def test_a_sweep_of_many_planes_compares_small_pictures_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It finds the same as without, and asks for a part of the planes."""
    views = [enlarged(middle(view, 64)) for view in around()[:3]]
    offsets = np.linspace(-0.6, 0.6, 25)
    plain, asked = plane_sweep._sweep, []

    def noted(grey, greys, H, half, ranges):
        asked.append((grey.shape, len(H), ranges))
        return plain(grey, greys, H, half, ranges)

    monkeypatch.setattr(plane_sweep, "_sweep", noted)
    chosen, _ = sweep(views[0], views[1:], UP, offsets, 5)
    assert [(shape, planes) for shape, planes, _ in asked] == [((64, 64), 13), ((128, 128), 25)]
    widths = np.diff(asked[1][2], axis=2) + 1
    assert np.median(widths) < 15
    monkeypatch.setattr(plane_sweep, "_MANY_PLANES", 1000)
    through_all, score = sweep(views[0], views[1:], UP, offsets, 5)
    sure = np.isfinite(through_all) & (score > 0.6)
    assert sure.mean() > 0.3
    assert (np.abs(chosen - through_all)[sure] < 1e-3).mean() > 0.97
