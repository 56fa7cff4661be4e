"""What grasping plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["sampled_antipodal", "sampled_cnn"])
def test_answer(recorded, exercised, name) -> None:
    # The network computes in single precision.
    few = "grasping.samples=20", "grasping.downward_yaws=9", "grasping.rehearsed=1"
    recorded(exercised("grasping", name, *few), relative=1e-5)


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.grasping"))
