"""What monitoring plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["hold_state", "jaw_slip", "payload_drop"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("monitoring", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.monitoring"))
