"""Both aligners, on a boulder on a corner of ground."""

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.local_fit import _within_reach
from executive_plugins.alignment.point_to_plane import PointToPlane
from executive_plugins.alignment.settings import GicpSettings, PointToPlaneSettings
from executive_plugins.alignment.thinning import grid_for

from executive.errors import DataError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between, exp_so3
from executive.interfaces.alignment import Aligner
from executive.messages.cloud import Cloud

GICP, PLANE = Gicp(GicpSettings()), PointToPlane(PointToPlaneSettings())
ALIGNERS = [GICP, PLANE]
# Noise of 8 mm in voxels of 5 cm. On a smooth boulder normals alone say little about its turning
# about itself.
TOLERANCE_M = {GICP: 0.01, PLANE: 0.03}


def boulder(seed: int, noise_m: float = 0.008) -> np.ndarray:
    """A lumpy, lopsided surface of about a metre, freshly sampled by each seed."""
    rng = np.random.default_rng(seed)
    d = rng.normal(size=(6000, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    radius = 0.6 + 0.12 * np.sin(3 * d[:, 0] + 1) * np.cos(2 * d[:, 1]) + 0.08 * d[:, 2] * d[:, 0]
    return d * (radius + rng.normal(0, noise_m, len(d)))[:, None] * [1, 0.75, 0.6]


@pytest.mark.parametrize("aligner", ALIGNERS)
@pytest.mark.parametrize("seed", range(4))
def test_a_known_motion_is_recovered(aligner: Aligner, seed: int) -> None:
    rng = np.random.default_rng(seed)
    T = pose(exp_so3(rng.normal(0, 0.05, 3)), rng.normal(0, 0.05, 3))
    source = transform(inverse(T), boulder(seed))
    found = aligner.align(Cloud("map", boulder(100 + seed)), Cloud("map", source), np.eye(4), 0.3)
    assert found.accepted, found.reason
    assert (
        np.linalg.norm(found.apply(source) - transform(T, source), axis=1).max()
        < TOLERANCE_M[aligner]
    )
    assert found.overlap > 0.9
    assert found.rmse_m < 0.04


def test_half_a_surface_is_enough() -> None:
    T = pose(exp_so3(np.array([0.02, -0.03, 0.06])), np.array([0.06, -0.04, 0.02]))
    seen = boulder(7)
    source = transform(inverse(T), boulder(8))
    found = GICP.align(
        Cloud("map", seen[seen[:, 0] + 0.4 * seen[:, 1] < 0.2]),
        Cloud("map", source),
        np.eye(4),
        0.3,
    )
    assert found.accepted, found.reason
    assert np.linalg.norm(found.T_target_source[:3, 3] - T[:3, 3]) < 0.02
    assert angle_between(found.T_target_source[:3, :3], T[:3, :3]) < np.radians(1.5)
    assert found.overlap < 0.95


def test_a_fit_that_wanders_beyond_the_reach_is_refused() -> None:
    credulous = PointToPlane(PointToPlaneSettings(max_rmse_m=1.0, min_overlap=0.0))
    away = Cloud("map", boulder(8) + [0, 0.25, 0])
    found = credulous.align(Cloud("map", boulder(7)), away, np.eye(4), 0.06)
    assert not found.accepted
    assert "slid away" in found.reason


def stone_on_ground(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return what is seen from one side of a block on the ground, and the block's whole surface."""
    rng = np.random.default_rng(seed)
    size = np.array([1.3, 0.9, 0.6])
    whole = rng.uniform(-0.5, 0.5, (5000, 3))
    face = rng.integers(3, size=len(whole))
    whole[np.arange(len(whole)), face] = rng.choice([-0.5, 0.5], len(whole))
    whole = whole * size @ exp_so3(np.array([0.15, 0.1, 0.4])).T + [0, 0, 0.5]
    outward = (whole - [0, 0, 0.5]) @ exp_so3(np.array([0.15, 0.1, 0.4]))
    normals = np.sign(outward) * (np.abs(np.abs(outward) - 0.5 * size) < 1e-9)
    normals = normals @ exp_so3(np.array([0.15, 0.1, 0.4])).T
    seen = whole[np.einsum("ij,ij->i", normals, [-6.0, -1.0, 3.0] - whole) > 0]
    ground = np.column_stack([rng.uniform(-1.5, 1.5, (4000, 2)), np.zeros(4000)])
    in_shadow = (np.abs(ground[:, 1]) < 0.7) & (ground[:, 0] > -0.5)
    view = np.vstack([seen, ground[~in_shadow]])
    return view + rng.normal(0, 0.012, view.shape), whole + rng.normal(0, 0.01, whole.shape)


@pytest.mark.parametrize("aligner", ALIGNERS)
@pytest.mark.parametrize("seed", range(3))
def test_what_the_target_does_not_show_of_a_stone_does_not_turn_it(
    aligner: Aligner, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    view, whole = stone_on_ground(seed)
    T = pose(exp_so3(rng.normal(0, 0.03, 3)), rng.normal(0, 0.05, 3))
    model = Cloud("map", transform(inverse(T), whole))
    found = aligner.align(Cloud("map", view), model, np.eye(4), 0.3)
    assert found.accepted, found.reason
    assert angle_between(found.T_target_source[:3, :3], T[:3, :3]) < 0.05


@pytest.mark.parametrize("aligner", ALIGNERS)
def test_the_answer_moves_with_the_frame(aligner: Aligner) -> None:
    T_far = pose(exp_so3(np.array([0.1, 0.2, 1.0])), np.array([400_000.0, 5_200_000.0, 400.0]))
    T = pose(exp_so3(np.array([0.02, 0, 0.05])), np.array([0.05, 0, 0]))
    target, source = boulder(1), transform(inverse(T), boulder(2))
    near = aligner.align(Cloud("map", target), Cloud("map", source), np.eye(4), 0.3)
    far = aligner.align(Cloud("utm", transform(T_far, target)), Cloud("map", source), T_far, 0.3)
    expected = transform(T_far @ near.T_target_source, source)
    assert (
        np.linalg.norm(far.apply(source) - expected, axis=1).max() < TOLERANCE_M[aligner]
    )  # the grid lies otherwise


@pytest.mark.parametrize("aligner", ALIGNERS)
def test_another_thing_is_refused_with_the_reason(aligner: Aligner) -> None:
    rng = np.random.default_rng(3)
    ground = np.column_stack([rng.uniform(-2, 2, (8000, 2)), np.zeros(8000)])
    found = aligner.align(Cloud("map", ground), Cloud("map", boulder(1)), np.eye(4), 0.3)
    assert not found.accepted
    assert "overlap" in found.reason


@pytest.mark.parametrize("aligner", ALIGNERS)
def test_a_target_out_of_reach_is_refused(aligner: Aligner) -> None:
    found = aligner.align(Cloud("map", boulder(1) + 50), Cloud("map", boulder(1)), np.eye(4), 0.3)
    assert not found.accepted
    assert "reach" in found.reason
    np.testing.assert_array_equal(found.T_target_source, np.eye(4))


@pytest.mark.parametrize("aligner", ALIGNERS)
def test_a_bad_request_is_an_error(aligner: Aligner) -> None:
    cloud = Cloud("map", boulder(1))
    with pytest.raises(DataError, match="positive reach"):
        aligner.align(cloud, cloud, np.eye(4), 0.0)
    with pytest.raises(DataError, match="no rigid pose"):
        aligner.align(cloud, cloud, 2 * np.eye(4), 0.3)


def corridor(seed: int, gap_m: float) -> np.ndarray:
    """Return a floor and two walls, the floor sampled in lines so far apart, without an end."""
    rng = np.random.default_rng(seed)
    y = np.arange(-2, 2, gap_m) + rng.uniform(0, gap_m)
    x = rng.uniform(-4, 4, (len(y), 400))
    floor = np.column_stack([x.ravel(), np.repeat(y, 400), np.zeros(x.size)])
    z = np.arange(0.1, 1.5, gap_m) + rng.uniform(0, gap_m)
    x = rng.uniform(-4, 4, (len(z), 400))
    walls = [
        np.column_stack([x.ravel(), np.full(x.size, side), np.repeat(z, 400)]) for side in (-2, 2)
    ]
    points = np.vstack([floor, *walls])
    return points + rng.normal(0, 0.005, points.shape)


@pytest.mark.parametrize("discount", [True, False])
def test_gaps_between_a_targets_lines_are_not_held_against_a_fit_on_request(discount: bool) -> None:
    settings = GicpSettings(max_rmse_m=0.025, discount_gaps=discount)
    found = Gicp(settings).align(
        Cloud("map", corridor(1, 0.12)), Cloud("map", corridor(2, 0.12)), np.eye(4), 0.3
    )
    assert found.rmse_m > 0.03
    assert found.accepted == discount, found.reason
    assert "without the target's gaps" in found.reason
    assert ("discount_gaps" in found.reason) != discount


def test_another_surface_is_refused_by_its_distance_across() -> None:
    settings = GicpSettings(max_rmse_m=0.025, discount_gaps=True)
    bent = corridor(2, 0.03)
    bent[:, 2] += 0.05 * np.sin(4 * bent[:, 0])
    found = Gicp(settings).align(
        Cloud("map", corridor(1, 0.03)), Cloud("map", bent), np.eye(4), 0.3
    )
    assert not found.accepted
    assert "above 2.5 cm" in found.reason


def test_the_direction_that_nothing_determines_is_told() -> None:
    found = GICP.align(
        Cloud("map", corridor(1, 0.04)), Cloud("map", corridor(2, 0.04)), np.eye(4), 0.3
    )
    assert found.uncertainty is not None
    variances, axes = np.linalg.eigh(found.uncertainty.covariance[3:, 3:])
    assert abs(axes[0, -1]) > 0.98  # along the corridor
    assert variances[-1] > 25 * variances[-2]
    assert "weak: sliding along (1.00" in found.reason


def terrain(seed: int, apart_m: float, phase: float = 0.0) -> np.ndarray:
    """Return hills of 12 m by 12 m whose points are so far apart."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-6, 6, (int((12 / apart_m) ** 2), 2))
    z = 0.4 * np.sin(1.1 * xy[:, 0] + phase) + 0.3 * np.cos(0.9 * xy[:, 1] + phase)
    return np.column_stack([xy, z]) + rng.normal(0, 0.005, (len(xy), 3))


def test_points_far_apart_are_matched_by_their_own_spacing() -> None:
    T = pose(exp_so3(np.array([0.0, 0.01, 0.01])), np.array([0.1, -0.1, 0.05]))
    source = Cloud("map", transform(inverse(T), terrain(2, 0.15)))
    found = GICP.align(Cloud("map", terrain(1, 0.15)), source, np.eye(4), 0.3)
    assert found.rmse_m > GicpSettings().max_rmse_m  # what points so far apart have anyhow
    assert found.accepted, found.reason
    assert np.linalg.norm(found.T_target_source[:3, 3] - T[:3, 3]) < 0.02


def test_other_ground_is_refused_however_far_its_points_are_apart() -> None:
    source = Cloud("map", terrain(2, 0.15, phase=0.8))
    found = GICP.align(Cloud("map", terrain(1, 0.15)), source, np.eye(4), 0.3)
    assert not found.accepted


def test_a_cloud_of_many_points_is_thinned_on_a_coarser_grid() -> None:
    plane = np.random.default_rng(3).uniform(0, 10, (100_000, 3)) * [1, 1, 0]
    cells = len(np.unique(np.floor(plane / 0.05), axis=0))
    assert grid_for(plane, 0.05) == pytest.approx(0.05 * np.sqrt(cells / 10_000), rel=0.05)
    assert grid_for(plane[:5000], 0.05) == 0.05


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_points_in_reach_are_those_beside_the_others_on_every_side(axis: int) -> None:
    others = np.array([[0.0, 0.0, 0.0], [4.0, 4.0, 4.0]])
    places = (-1.1, -0.9, 0.5, 3.5, 4.9, 5.1)
    points = np.full((len(places), 3), 2.0)
    points[:, axis] = places
    assert _within_reach(points, others, 1.0).tolist() == [False, True, True, True, True, False]


def hall(T: np.ndarray, seed: int) -> np.ndarray:
    """Return a scan of 16 rings from a pose in a hall of 28 m by 20 m, with noise along rays."""
    rng = np.random.default_rng(seed)
    steep, turn = np.meshgrid(np.radians(np.linspace(-25, 15, 16)), np.linspace(0, 2 * np.pi, 1500))
    rays = np.column_stack(
        [
            (np.cos(steep) * np.cos(turn)).ravel(),
            (np.cos(steep) * np.sin(turn)).ravel(),
            np.sin(steep).ravel(),
        ]
    )
    range_m = np.full(len(rays), np.inf)
    for axis, at_m in ((0, -12.0), (0, 16.0), (1, -8.0), (1, 12.0), (2, -1.8), (2, 6.0)):
        speed = rays @ T[axis, :3]
        hits_m = (at_m - T[axis, 3]) / np.where(np.abs(speed) < 1e-9, 1e-9, speed)
        range_m = np.where(hits_m > 0, np.minimum(range_m, hits_m), range_m)
    return rays * (range_m + rng.normal(0, 0.015, len(rays)))[:, None]


@pytest.mark.parametrize("aligner", ALIGNERS)
@pytest.mark.parametrize("seed", range(2))
def test_two_scans_of_few_rings_are_not_drawn_from_ring_to_ring(
    aligner: Aligner, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    T = pose(exp_so3(rng.normal(0, 0.01, 3)), rng.normal(0, [0.3, 0.3, 0.03]))
    guess = T @ pose(exp_so3(rng.normal(0, 0.003, 3)), rng.normal(0, 0.05, 3))
    clouds = Cloud("target", hall(np.eye(4), seed)), Cloud("source", hall(T, seed + 100))
    found = aligner.align(*clouds, guess, 0.3)
    assert found.accepted, found.reason
    assert found.overlap > 0.7  # most points lie between two rings of the other scan
    assert np.linalg.norm(found.T_target_source[:3, 3] - T[:3, 3]) < 0.005
