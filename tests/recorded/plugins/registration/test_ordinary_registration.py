"""What registration plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["segment_fpfh", "segment_shot", "kiss_matcher"])
def test_answer(recorded, exercised, name) -> None:
    # The refinement stops at a tolerance of its own.
    recorded(exercised("registration", name), relative=1e-6)


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.registration"))
