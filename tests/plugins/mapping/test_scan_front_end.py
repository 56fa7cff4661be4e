"""Where a lidar was while it scanned, from the motion around the scan."""

from collections.abc import Callable

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
