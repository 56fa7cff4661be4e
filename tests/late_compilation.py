"""Runs a plugin or a mission, and tells what is compiled, or read from a cache, after the start.

    python tests/late_compilation.py plugin CAPABILITY NAME [SETTING…]
    python tests/late_compilation.py mission FILE FOLDER [SETTING…]

A compiled function that meets new types is compiled for them, which takes up to three seconds, or
is read from a cache, which takes some hundredths. It prints such functions with their types as a
JSON list. A process of its own is needed, in which nothing else has compiled them.
"""

import json
import sys
from contextlib import suppress
from pathlib import Path
from unittest.mock import patch

from numba.core.dispatcher import Dispatcher

from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.run import Run
from executive.testing.exercise import RefusedError, exercise_of
from executive.testing.subject import subject_of
from executive.tree.load import load_mission


def compiled() -> set[str]:
    """Return the package's compiled functions, each with the types that it is ready for."""
    values = [
        value
        for name, module in sys.modules.items()
        if name.partition(".")[0] in ("executive", "executive_plugins")
        for value in vars(module).values()
        if issubclass(type(value), Dispatcher)
    ]
    return {
        f"{one.py_func.__module__}.{one.py_func.__name__}{types}"
        for one in values
        for types in one.signatures
    }


def late_of_plugin(capability: str, name: str, *settings: str) -> set[str]:
    """Return what is compiled while a started plugin is exercised as the conformance kit does."""
    subject, exercise = subject_of(capability, name, settings), exercise_of(capability)
    assert exercise is not None
    inputs = exercise.inputs(subject.machine)
    with subject.started() as plugin:
        ready = compiled()
        with suppress(RefusedError):
            exercise.run(plugin, inputs)
        return compiled() - ready


def late_of_mission(mission: str, folder: str, *settings: str) -> set[str]:
    """Return what is compiled from the first tick of a mission in lock-step to its last."""
    ready: set[str] = set()
    run = Mission.run

    def observed(self, after_tick):
        ready.update(compiled())
        ending = run(self, after_tick)
        ready.symmetric_difference_update(compiled())
        return ending

    with patch.object(Mission, "run", observed):
        options = Options(run_dir=Path(folder))
        result = Run(load_mission(mission, settings), options).execute(lambda mission: None)
    assert result.report.outcome == "success", result.summary
    return ready


if __name__ == "__main__":
    late_of = {"plugin": late_of_plugin, "mission": late_of_mission}[sys.argv[1]]
    print(json.dumps(sorted(late_of(*sys.argv[2:]))))
