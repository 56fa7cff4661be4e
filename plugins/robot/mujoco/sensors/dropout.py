"""Time spans in which a sensor sends nothing."""

from collections.abc import Collection, Sequence

from pydantic import Field, model_validator

from executive.config import Seconds, Settings
from executive.errors import ConfigError, did_you_mean


class Dropout(Settings):
    """A time span in which one sensor sends nothing."""

    sensor: str = Field(description="Name of the sensor in robot.yaml.")
    from_s: Seconds = Field(ge=0, description="First time without samples [s].")
    to_s: Seconds = Field(gt=0, description="First time with samples again [s].")

    @model_validator(mode="after")
    def _check(self) -> "Dropout":
        if self.from_s >= self.to_s:
            raise ValueError(f"to_s {self.to_s:g} must be later than from_s {self.from_s:g}")
        return self


def check_dropouts(dropouts: Sequence[Dropout], sensors: Collection[str]) -> None:
    """Refuse names of sensors that the machine does not have.

    Raises:
        ConfigError: If there is one; the message gives the nearest name.
    """
    for dropout in dropouts:
        if dropout.sensor not in sensors:
            raise ConfigError(
                f"robot.sensors.dropouts: the machine has no sensor '{dropout.sensor}'"
                f"{did_you_mean(dropout.sensor, sensors)}"
            )


def is_silent(dropouts: Sequence[Dropout], sensor: str, time_s: float) -> bool:
    """Return whether a sensor has dropped out at a time [s]."""
    return any(d.sensor == sensor and d.from_s <= time_s < d.to_s for d in dropouts)
