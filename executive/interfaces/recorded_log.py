"""How a plugin that estimates from recorded logs adapts to the log that it is run on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from executive.interfaces.plugin import Plugin


@dataclass(frozen=True, slots=True)
class RecordedBody:
    """The body that carried the sensors while a log was recorded.

    Attributes:
        imus: Frames of the inertial sensors in the log, in order of appearance; at least one.
        datum: The first fix with a fixed RTK solution: latitude [deg], longitude [deg],
            altitude [m].
        is_described: Whether the sensors' noise and mounting come from a machine's description.
            If not, the mounting comes from the log's static transforms and the noise is a guess.
        clock_std_s: Standard deviation of what is left of the receivers' clocks after a calibration
            [s]; None if none was made.
    """

    imus: Sequence[str]
    datum: tuple[float, float, float]
    is_described: bool
    clock_std_s: float | None = None


class LogPlugin(Plugin):
    """Base of the plugins that `executive estimate` runs on a recorded log."""

    @classmethod
    def settings_for(cls, body: RecordedBody) -> Mapping[str, object]:
        """Return the settings that a log asks for, by the names of the fields of `Settings`.

        Nested settings are nested mappings. Settings of the user take precedence. The default is
        no setting at all.
        """
        return {}

    @property
    def datum(self) -> tuple[float, float, float] | None:
        """Origin of the map: latitude [deg], longitude [deg], altitude [m].

        None, the default, if the origin is the first fix with a fixed RTK solution.
        """
        return None
