"""What every viewer must do: take whatever it is shown, and never answer back."""

from pathlib import Path

from executive.interfaces.viewing import Viewer
from executive.machine.machine import Machine
from executive.testing.exercises.viewing import messages

CAPABILITY = "viewing"


def test_it_takes_every_kind_of_value(plugin: Viewer, machine: Machine, tmp_path: Path) -> None:
    plugin.open(str(tmp_path / "recording.rrd"))
    for k, (entity, value) in enumerate(messages(machine)):
        plugin.show(k / 10, entity, value)


def test_it_can_be_closed_twice_after_a_recording(plugin: Viewer, tmp_path: Path) -> None:
    plugin.open(str(tmp_path / "recording.rrd"))
    plugin.close()
    plugin.close()
