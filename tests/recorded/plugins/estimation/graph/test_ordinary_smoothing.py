"""What smoothing plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["batch_graph"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("smoothing", name))
