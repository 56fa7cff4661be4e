"""A message that contradicts itself is refused with a sentence; one at the limit is taken."""

import math

import numpy as np
import pytest

from executive.errors import DataError
from executive.messages.drive import BasePath, DrivePlan, DriveTrouble
from executive.messages.region import Region
from executive.messages.sector import Sector
from executive.messages.slot_layout import Row
from executive.messages.structure import Structure

POSES = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
TROUBLE = next(iter(DriveTrouble))


def path(**changed) -> BasePath:
    whole = {"poses_map": POSES, "along_m": [0, 1], "curvature_1_m": [0, 0], "direction": (1, 1)}
    return BasePath(**whole | changed)


def test_a_plan_to_drive_is_a_path_or_a_trouble_with_its_reason() -> None:
    DrivePlan(path())
    DrivePlan(None, TROUBLE, "a ditch")
    for arguments in [
        (None,), (None, TROUBLE), (None, None, "a ditch"), (path(), TROUBLE, "a ditch")
    ]:  # fmt: skip
        with pytest.raises(DataError, match="a path, or a trouble and its reason"):
            DrivePlan(*arguments)


def test_a_path_goes_forwards_or_backwards_and_its_length_never_falls() -> None:
    path(direction=(-1, 1), along_m=[0, 0])
    with pytest.raises(DataError, match="needs two poses"):
        path(poses_map=POSES[:1], along_m=[0], curvature_1_m=[0], direction=(1,))
    for direction in [(0, 1), (1, 2), (1, -2)]:
        with pytest.raises(DataError, match="is 1 or -1"):
            path(direction=direction)
    with pytest.raises(DataError, match="never falls"):
        path(along_m=[1, 0.9])


def region(corners) -> Region:
    return Region("yard", np.array(corners, dtype=float))


def test_a_region_has_an_area_and_does_not_cross_itself() -> None:
    region([[0, 0], [1, 0], [0, 1]])
    region([[0, 1], [1, 0], [0, 0]])
    for corners in [
        [[0, 0], [1, 0]],
        [[0, 0], [1, 1], [2, 2]],
        [[0, 0], [2, 2], [2, 0], [0, 2]],
    ]:
        with pytest.raises(DataError, match="region"):
            region(corners)


@pytest.mark.parametrize(
    "changed",
    [
        {"nearest_m": -0.1},
        {"nearest_m": 5.0},
        {"farthest_m": math.inf},
        {"farthest_m": math.nan},
        {"angle_rad": 0.0},
    ],
)
def test_a_sector_has_a_width_and_an_angle(changed) -> None:
    whole = {"centre_map": (0, 0), "nearest_m": 0.0, "farthest_m": 5.0}
    whole |= {"heading_rad": 0.0, "angle_rad": 1.0}
    Sector(**whole)
    with pytest.raises(DataError, match="sector"):
        Sector(**whole | changed)


def test_a_gap_between_stones_is_never_negative() -> None:
    for gap_m in (-0.01, math.nan):
        with pytest.raises(DataError, match="at least 0 m"):
            Row((0, 0), 0.0, gap_m)
    Row((0, 0), 0.0, 0.0)


@pytest.mark.parametrize(
    "changed",
    [
        {"line": np.zeros((0, 2))},
        {"line": np.zeros((2, 2))},
        {"height_m": 0.0},
        {"faces": 3},
        {"faces": 0},
        {"batter_rad": math.atan(0.51)},
    ],
)
def test_a_structure_has_a_line_a_height_and_a_crown(changed) -> None:
    whole = {"name": "wall", "line": np.array([[0.0, 0.0], [4.0, 0.0]]), "height_m": 1.0}
    whole |= {"thickness_m": 1.0, "faces": 2, "batter_rad": math.atan(0.49)}
    Structure(**whole)
    with pytest.raises(DataError, match="structure 'wall'"):
        Structure(**whole | changed)
