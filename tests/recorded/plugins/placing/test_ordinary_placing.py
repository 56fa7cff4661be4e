"""What placing plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["slots"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("placing", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.placing"))
