"""What alignment plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["gicp", "point_to_plane"])
def test_answer(recorded, exercised, name) -> None:
    # The refinement stops at a tolerance of its own.
    recorded(exercised("alignment", name), relative=1e-6)


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.alignment"))
