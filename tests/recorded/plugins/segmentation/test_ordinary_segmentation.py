"""What segmentation plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["ground_and_clusters"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("segmentation", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.segmentation"))
