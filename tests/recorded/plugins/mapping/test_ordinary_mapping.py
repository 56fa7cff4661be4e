"""What mapping plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["voxel_map", "pose_graph"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("mapping", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.mapping"))
