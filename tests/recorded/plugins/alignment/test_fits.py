"""The gate of an alignment: too few points, out of reach, slid away, and its exact limits."""

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.local_fit import measure
from executive_plugins.alignment.settings import AlignmentSettings, GicpSettings
from executive_plugins.alignment.surface import Surface

from executive.errors import DataError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3
from executive.messages.cloud import Cloud
from executive.testing.exercises.alignment import T_TRUE, clouds

# The iterations stop at a tolerance of their own.
RELATIVE = 1e-6


def few(count: int, offset=(0.0, 0.0, 0.0)) -> Cloud:
    rng = np.random.default_rng(1)
    return Cloud("map", rng.uniform(-0.5, 0.5, (count, 3)) + offset)


@pytest.mark.parametrize(("target", "source"), [(19, 50), (50, 19), (20, 20), (20, 21)])
def test_fewest_points(recorded, target, source) -> None:
    found = Gicp(GicpSettings()).align(few(target), few(source), np.eye(4), 0.3)
    recorded(found, relative=RELATIVE)


def test_nothing_within_reach(recorded) -> None:
    gicp = Gicp(GicpSettings())
    told = [gicp.align(few(60), few(60, (d, 0, 0)), np.eye(4), 0.25) for d in (1.0, 1.2, 1.4, 3.0)]
    recorded(told, relative=RELATIVE)


@pytest.mark.parametrize("max_distance_m", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("overlap", [0.4, 0.99])
def test_gates(recorded, max_distance_m, overlap) -> None:
    target, source = clouds()
    thin = Cloud("model", source.points[::9]), Cloud("map", target.points[::9])
    settings = GicpSettings(min_overlap=overlap, max_rmse_m=0.02, max_iterations=12)
    guess = pose(exp_so3(np.array([0.0, 0, 0.05])), np.array([0.06, -0.05, 0.02]))
    recorded(Gicp(settings).align(thin[1], thin[0], guess, max_distance_m), relative=RELATIVE)


def test_a_sliding_plane_is_refused(recorded) -> None:
    xy = np.random.default_rng(2).uniform(-1, 1, (3000, 2))
    plane = np.column_stack([xy, 0.2 * xy[:, 0] ** 2])
    turned = Cloud("model", transform(np.linalg.inv(T_TRUE), plane))
    found = Gicp(GicpSettings()).align(Cloud("map", plane), turned, np.eye(4), 0.03)
    recorded(found, relative=RELATIVE)


def test_measure(recorded) -> None:
    grid = np.stack(np.meshgrid(*(np.arange(5.0),) * 3), axis=-1).reshape(-1, 3)
    settings = AlignmentSettings(voxel_m=0.5, gate_distance_m=0.5)
    offsets = (0.0, 0.25, 0.5, 0.75, 90.0)
    surface = Surface(grid, 0.5, settings.neighbours)
    recorded([measure(grid, surface, grid[:40] + [d, 0, 0], 0.5, settings) for d in offsets])


def test_wrong_guesses(recorded) -> None:
    told = []
    for guess, reach in (
        (np.eye(4), 0.0),
        (np.eye(4), -1.0),
        (np.eye(3), 0.3),
        (np.diag([1.0, 1, -1, 1]), 0.3),
        (np.diag([1.0, 1, 1.001, 1]), 0.3),
        (np.full((4, 4), np.nan), 0.3),
    ):
        with pytest.raises(DataError) as refused:
            Gicp(GicpSettings()).align(few(60), few(60), guess, reach)
        told.append(refused.value)
    nearly = np.diag([1.0, 1, 1.00004, 1])
    recorded((told, Gicp(GicpSettings()).align(few(60), few(60), nearly, 0.3)), relative=RELATIVE)
