"""What grasping plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["sampled_antipodal", "sampled_cnn"])
def test_answer(recorded, exercised, name) -> None:
    # The network computes in single precision.
    recorded(exercised("grasping", name), relative=1e-5)
