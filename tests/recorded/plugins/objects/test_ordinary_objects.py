"""What objects plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["sqlite"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("objects", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.objects"))
