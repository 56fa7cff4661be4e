"""What robot plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["mujoco", "kinematic"])
def test_answer(recorded, exercised, name) -> None:
    # The contact solver stops at a tolerance of its own, 1e-8.
    recorded(exercised("robot", name), relative=1e-6)


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.robot"))
