"""The links of a machine are drawn once, those that have a shape."""

from types import SimpleNamespace
from typing import Any

from executive_plugins.viewing.machine_drawing import MachineDrawing
from executive_plugins.viewing.palette import MACHINE

from executive.machine.machine import load_machine


def test_each_link_with_a_shape_is_drawn_once_in_two_shades_in_turn() -> None:
    machine, drawn = load_machine("m545"), {}

    def log(path: str, solid: Any, *, static: bool) -> None:
        assert static
        drawn[path] = solid.albedo_factor.as_arrow_array().to_pylist()

    drawing = MachineDrawing(machine, SimpleNamespace(log=log))
    assert not drawn  # a recording without an estimate has no machine at its origin
    drawing.draw_solids()
    first = dict(drawn)
    drawn.clear()
    drawing.draw_solids()
    assert not drawn
    drawn.update(first)
    shaped = [name for name, link in machine.links.items() if link.shapes]
    assert shaped
    assert list(drawn) == [f"world/machine/{name}" for name in shaped]
    shades = {n: int(MACHINE[0] * (1.0 if n % 2 else 0.8)) for n in range(len(machine.links))}
    for number, name in enumerate(machine.links):
        if name in shaped:
            assert {c >> 24 for c in drawn[f"world/machine/{name}"]} == {shades[number]}
