"""What estimation plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["gnss_imu_filter", "error_state_ekf", "dual_graph"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("estimation", name))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.estimation"))
