"""Where a lidar was while it scanned, from the motion around the scan."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from executive_plugins.mapping.scan_front_end import ScanFrontEnd
from executive_plugins.mapping.settings import VoxelMapSettings

from executive.machine.machine import Machine


@pytest.mark.parametrize("lidar", ["lidar_vertical", "lidar_horizontal"])
def test_a_lidar_stands_where_it_was_in_the_middle_of_its_scan(
    machine: Machine, make_yard: Callable[..., object], lidar: str
) -> None:
    yard = make_yard(0.5)
    scan = yard.scan(lidar, 1.0, 40)
    middle_s = (scan.point_stamps_s[0] + scan.point_stamps_s[-1]) / 2
    expected = (yard.T_map_cabin(middle_s) @ yard.T_cabin[lidar])[:3, 3]
    found = ScanFrontEnd(machine, VoxelMapSettings()).lidar_map(scan, yard.motion(1.0))
    # The motion is interpolated between samples of 20 ms: 0.5 rad/s at some 4 m, off by < 0.1 mm.
    assert np.allclose(found, expected, atol=2e-4)
    ends = [
        (yard.T_map_cabin(s) @ yard.T_cabin[lidar])[:3, 3] for s in scan.point_stamps_s[[0, -1]]
    ]
    assert min(np.linalg.norm(found - end) for end in ends) > 5e-3


@pytest.mark.parametrize("held", [False, True])
def test_a_return_is_of_the_machine_as_it_stood_at_the_nearest_end_of_a_slice(
    machine: Machine, make_yard: Callable[..., object], held: bool
) -> None:
    """Slices of hardly 10 ms from the first return on: 4 and 6 ms later, and so on."""
    yard, front_end = make_yard(0.5), ScanFrontEnd(machine, VoxelMapSettings(slice_s=0.01))
    offsets_s = np.array([0.0, 0.004, 0.006, 0.014, 0.016, 0.0299])
    T_cabin = yard.T_cabin
    grasp_cabin = T_cabin["gripper"][:3, :3] @ machine.gripper.grasp_centre
    place_cabin = T_cabin["gripper"][:3, 3] + grasp_cabin
    near = np.tile(place_cabin, (len(offsets_s), 1))
    seen = yard.as_scan(near, "lidar_horizontal")
    scan = replace(seen, stamp_s=1.03, point_stamps_s=1.0 + offsets_s)
    asked: list[list[int]] = []

    def inside(points: Any, ends: Any, lidar: str, frames: Any, radius_m: float) -> Any:
        asked.append(ends.tolist())
        assert len(frames) == 4
        return ends == 1  # what the machine covers at the end of the first slice

    front_end._filter = SimpleNamespace(inside=inside)
    motion = yard.motion(1.04)
    verb = front_end.place_held if held else front_end.place
    kept = verb(scan, motion, 5.0)
    assert asked == [[0, 0, 1, 1, 2, 3]]
    assert len(kept) == 4
