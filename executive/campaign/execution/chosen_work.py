"""The installed work of a trial, with its arguments checked."""

from collections.abc import Mapping
from pathlib import Path

from pydantic import ValidationError

from executive import registry
from executive.campaign.trial import Trial
from executive.config import Settings
from executive.errors import ConfigError
from executive.interfaces.work import Work


def work_of(trial: Trial) -> tuple[Work, Settings]:
    """Return the work of a trial and its checked arguments.

    Raises:
        ConfigError: If no such work is installed, or it refuses the arguments.
    """
    found = registry.load(registry.WORKS, trial.work)
    if not issubclass(found, Work):
        raise ConfigError(f"work '{trial.work}': {found.__qualname__} does not derive from Work")
    work = found()
    try:
        return work, work.Arguments.model_validate(dict(trial.arguments))
    except ValidationError as error:
        mistakes = "; ".join(
            f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors()
        )
        raise ConfigError(f"work '{trial.work}' refuses its arguments: {mistakes}") from error


def inputs_of(trial: Trial) -> Mapping[str, Path]:
    """Return the files and folders that the run of a trial reads, by name.

    Raises:
        ConfigError: As `work_of`, or if one does not exist.
    """
    work, arguments = work_of(trial)
    found = work.inputs(arguments)
    for name, path in found.items():
        if not path.exists():
            raise ConfigError(f"work '{trial.work}': its input '{name}' does not exist: {path}")
    return found
