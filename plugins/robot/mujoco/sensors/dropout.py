"""Spans of time in which a sensor is silent."""

from collections.abc import Collection, Sequence

from pydantic import Field, model_validator

from executive.config import Seconds, Settings
from executive.errors import ConfigError, did_you_mean


class Dropout(Settings):
    """One sensor, one span."""

    sensor: str = Field(description="Name of the sensor in robot.yaml.")
    from_s: Seconds = Field(ge=0, description="First time without samples [s].")
    to_s: Seconds = Field(gt=0, description="First time with samples again [s].")

    @model_validator(mode="after")
    def _check(self) -> "Dropout":
        if self.from_s >= self.to_s:
            raise ValueError(f"to_s {self.to_s:g} must lie after from_s {self.from_s:g}")
        return self


def check_dropouts(dropouts: Sequence[Dropout], sensors: Collection[str]) -> None:
    """Refuse the name of a sensor that the machine lacks.

    Raises:
        ConfigError: It says the nearest name.
    """
    for dropout in dropouts:
        if dropout.sensor not in sensors:
            raise ConfigError(
                f"robot.sensors.dropouts: the machine has no sensor '{dropout.sensor}'"
                f"{did_you_mean(dropout.sensor, sensors)}"
            )


def is_silent(dropouts: Sequence[Dropout], sensor: str, time_s: float) -> bool:
    """Say whether a sensor has dropped out at a time [s]."""
    return any(d.sensor == sensor and d.from_s <= time_s < d.to_s for d in dropouts)
