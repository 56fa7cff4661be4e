"""What the viewer draws of each kind of message: entities, shapes, colours and sizes."""

import numpy as np
import pytest
from executive_plugins.viewing import palette
from executive_plugins.viewing.message_drawing import draw

from executive.testing.exercises.viewing import messages


def shown(archetype) -> dict:
    """Return the components of a drawing by name: texts, or numbers as one array."""
    told = {}
    for batch in archetype.as_component_batches():
        name = batch.component_descriptor().component.rpartition(":")[2]
        values = list(leaves(batch.as_arrow_array().to_pylist()))
        numbers = [value for value in values if not isinstance(value, str)]
        texts = [value for value in values if isinstance(value, str)]
        told[name] = [np.array(numbers, dtype=float), texts]
    return told


def leaves(value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple):
        for one in value:
            yield from leaves(one)
    elif value is not None:
        yield value


@pytest.mark.parametrize("most", [10, 100_000])
def test_drawings(recorded, machine, most) -> None:
    told = []
    for entity, value in messages(machine):
        for path, archetype in draw(value, entity, machine.gripper, most):
            told.append((path, type(archetype).__name__, shown(archetype)))
    # The viewer keeps coordinates in single precision.
    recorded(told, relative=1e-5, absolute=1e-6)


def test_colours(recorded) -> None:
    """Recordings of all missions look alike."""
    named = {name: one for name, one in vars(palette).items() if name.isupper() and name[0] != "_"}
    heights = palette.of_heights(np.linspace(-1.0, 2.0, 60))
    flat = palette.of_heights(np.full(5, 0.3))
    recorded((named, [palette.of_number(k) for k in range(12)], heights, flat))
