"""What motion plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["hermite"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("motion", name))
