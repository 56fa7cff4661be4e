"""A plugin that a mission has chosen."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from executive.config import Settings

# What an error of a plugin means: `stop` ends the mission in a safe stop, `fail` lets the node fail
# that waited for it, and a stream plugin is used no more.
ON_ERROR = "on_error"
ON_ERROR_WORDS = ("stop", "fail")


@dataclass(frozen=True, slots=True)
class Selection:
    """A plugin that a mission has chosen.

    Attributes:
        name: Its name, as installed.
        settings: Checked settings.
        can_fail: Whether the mission goes on when the plugin raises an error (`on_error: fail`).
        uses: Name of the plugin that it is given, by capability, where there are several.
    """

    name: str
    settings: Settings
    can_fail: bool = False
    uses: Mapping[str, str] = field(default_factory=dict)
