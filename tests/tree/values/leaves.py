"""Leaves with settings of every dimension, and what they see, for tests of values."""

from dataclasses import dataclass

from pydantic import Field

from executive.config import Kilograms, Radians, Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, succeeded


@dataclass(frozen=True)
class Rock:
    """A rock.

    Attributes:
        id: Its number.
        mass_kg: Its mass.
        reach_m: Its size.
        density: Its density [kg/m3].
        label: What is written on it, if anything.
    """

    id: int
    mass_kg: float
    reach_m: float
    density: float
    label: str | None = None


@dataclass(frozen=True)
class Rocks:
    """What is seen.

    Attributes:
        rocks: All of them.
        largest: The heaviest.
    """

    rocks: list[Rock]
    largest: Rock


class See(Condition):
    """See two rocks."""

    def check(self) -> Outcome[Rocks]:
        small, large = Rock(1, 300.0, 0.4, 2600.0), Rock(2, 900.0, 0.6, 2700.0, "B")
        return succeeded(Rocks([small, large], large))


class TurnSettings(Settings):
    angle: Radians = Field(gt=-7, le=7, description="Where to.")
    times: int = Field(1, ge=1, le=5, description="How often.")
    label: str = Field("", description="What to say.")
    speeds: tuple[float, ...] = Field((), description="One a turn.")


@dataclass(frozen=True)
class Turned:
    """What a turn gives.

    Attributes:
        told: The settings.
        mass: A mass [kg].
    """

    told: str
    mass: float


class Turn(Action[TurnSettings]):
    """Turn."""

    def run(self, payload: Kilograms | None = None) -> Steps[Turned]:
        """Turn.

        Args:
            payload: What is held [kg].
        """
        yield None
        one = self.settings
        return succeeded(
            Turned(f"{one.angle:.3f} {one.times} {one.label} {one.speeds}", payload or 0.0)
        )


HEADER = (
    "api: 1\nmission: test\nplugins: {robot: mujoco, estimation: gnss_imu, mapping: voxel_map}\n"
)
LEAVES: dict[str, type] = {"See": See, "Turn": Turn}
