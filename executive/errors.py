"""Errors that users can act on, in a hierarchy by what they can do about them."""

from collections.abc import Iterable
from difflib import get_close_matches


class ExecutiveError(Exception):
    """Root of every error that this project raises on purpose."""


class ConfigError(ExecutiveError):
    """The mission file, a setting or an option is wrong: fix the file."""


class DataError(ExecutiveError):
    """A log, a cloud or a sensor's sample is wrong: fix the data or the sensor."""


class ShapeError(DataError):
    """An array has another shape, type or content than its contract says."""


class RobotError(ExecutiveError):
    """The machine or its driver failed: the mission brings the robot to a safe stop."""


class UnknownPluginError(ConfigError):
    """No plugin of that name is installed for the capability."""

    def __init__(self, capability: str, name: str, known: Iterable[str]) -> None:
        super().__init__(f"no {capability} plugin '{name}'{did_you_mean(name, known)}")


def nearest(word: str, known: Iterable[str]) -> str:
    """Return the known word that was probably meant, or an empty text."""
    return next(iter(get_close_matches(word, sorted(known), n=1, cutoff=0.6)), "")


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return the end of an error message: the nearest known word, or all known words."""
    known = sorted(known)
    if near := nearest(word, known):
        return f". Did you mean '{near}'?"
    return f"; there is: {', '.join(known)}" if known else "; there is none"
