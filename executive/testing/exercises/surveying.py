"""Surveying: one survey of the site that the plugin is set to."""

from collections.abc import Mapping

import numpy as np

from executive.errors import DataError
from executive.interfaces.surveying import Survey
from executive.machine.machine import Machine
from executive.testing.exercise import Exercise, RefusedError


class SurveyingExercise(Exercise[Survey]):
    """One survey; a plugin that has nothing to survey raises DataError, and says why."""

    def inputs(self, machine: Machine) -> Mapping[str, object]:
        return {}

    def run(self, plugin: Survey, inputs: Mapping[str, object]) -> object:
        try:
            return plugin.survey(np.random.default_rng(0))
        except DataError as error:
            raise RefusedError(str(error)) from error
