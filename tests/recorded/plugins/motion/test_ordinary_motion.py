"""What motion plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["hermite"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("motion", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.motion"))
