"""What objects plugins answer to the ordinary inputs of the conformance kit."""

import pytest


@pytest.mark.parametrize("name", ["sqlite"])
def test_answer(recorded, exercised, name) -> None:
    recorded(exercised("objects", name))
