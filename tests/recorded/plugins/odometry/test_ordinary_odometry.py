"""What odometry plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["scan_to_submap", "kiss_icp"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("odometry", name))
