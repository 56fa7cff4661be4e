"""Smoothing: six seconds of rest, all at once, and recordings that say nothing."""

from collections.abc import Callable, Mapping
from typing import TypedDict

from executive.interfaces.smoothing import TrajectorySmoother
from executive.machine.machine import Machine
from executive.messages.observation import Observation
from executive.testing.exercise import Exercise
from executive.testing.exercises.estimation import rest


class SmoothingInputs(TypedDict):
    """What the sensors of a machine at rest measure."""

    observations: tuple[Observation, ...]


class SmoothingExercise(Exercise[TrajectorySmoother, SmoothingInputs]):
    """One recording."""

    def inputs(self, machine: Machine) -> SmoothingInputs:
        return {"observations": tuple(rest(machine))}

    def run(self, plugin: TrajectorySmoother, inputs: SmoothingInputs) -> object:
        return tuple(plugin.smooth(inputs["observations"]))

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[TrajectorySmoother], object]]:
        first = tuple(rest(machine, 0.1))
        return {
            "an empty recording": lambda plugin: tuple(plugin.smooth(())),
            "a tenth of a second": lambda plugin: tuple(plugin.smooth(first)),
            "a recording backwards": lambda plugin: tuple(plugin.smooth(first[::-1])),
        }
