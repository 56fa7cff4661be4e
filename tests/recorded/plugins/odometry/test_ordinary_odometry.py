"""What odometry plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["scan_to_submap", "kiss_icp"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("odometry", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.odometry"))
