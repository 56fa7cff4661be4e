"""What segmentation plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["ground_and_clusters"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("segmentation", name))
