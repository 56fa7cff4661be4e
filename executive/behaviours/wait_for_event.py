"""Wait for an event of the journal."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from pydantic import Field, field_validator, model_validator

from executive.config import Seconds, Settings
from executive.errors import did_you_mean
from executive.events.event import Event, event_classes, plain
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded


class WaitForEventSettings(Settings):
    event: str = Field(
        examples=["StoneReleased"], description="Class of the event, as in docs/journal_events.md."
    )
    equals: Mapping[str, bool | int | float | str] = Field(
        {}, examples=[{"slot": 2}], description="Values that fields of the event must have."
    )
    at_least: Mapping[str, float] = Field({}, description="Smallest values of fields.")
    at_most: Mapping[str, float] = Field({}, description="Largest values of fields.")
    within: Seconds | None = Field(
        None,
        gt=0,
        examples=["60 s"],
        description="When no such event came in this time, the leaf fails [s]; by default never.",
    )

    @field_validator("event")
    @classmethod
    def _is_known(cls, name: str) -> str:
        if name not in event_classes():
            raise ValueError(f"no event '{name}'{did_you_mean(name, event_classes())}")
        return name

    @model_validator(mode="after")
    def _names_its_fields(self) -> "WaitForEventSettings":
        known = [one.name for one in fields(event_classes()[self.event])]
        for name in (*self.equals, *self.at_least, *self.at_most):
            if name not in known:
                raise ValueError(f"{self.event} has no field '{name}'{did_you_mean(name, known)}")
        return self


@dataclass(frozen=True, slots=True)
class EventSeen:
    """The event that was waited for.

    Attributes:
        event: The event, with its fields.
    """

    event: Event


class WaitForEvent(Action[WaitForEventSettings]):
    """Wait until an event of a class is written to the journal whose fields hold given values.

    What was written before the leaf began does not count.
    """

    on_resume = OnResume.REDO

    def run(self) -> Steps[EventSeen]:
        wanted = self.settings
        until_s = None if wanted.within is None else self.context.now_s() + wanted.within
        news = self.context.follow_journal()
        while True:
            for entry in news():
                if _matches(entry.event, wanted):
                    return succeeded(EventSeen(entry.event), f"{wanted.event} at {entry.node}")
            if until_s is not None and self.context.now_s() >= until_s:
                return failed(f"no {_told(wanted)} within {wanted.within:g} s")
            yield None


def _matches(event: Event, wanted: WaitForEventSettings) -> bool:
    if type(event).__name__ != wanted.event:
        return False
    found: dict[str, Any] = {one.name: plain(getattr(event, one.name)) for one in fields(event)}
    return (
        all(found[name] == value for name, value in wanted.equals.items())
        and all(_number(found[name]) >= low for name, low in wanted.at_least.items())
        and all(_number(found[name]) <= high for name, high in wanted.at_most.items())
    )


def _number(value: object) -> float:
    """Return a field as a number; what is none fulfils no bound."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number else float("nan")  # type: ignore[arg-type]


def _told(wanted: WaitForEventSettings) -> str:
    bounds = [
        *(f"{name} = {value}" for name, value in wanted.equals.items()),
        *(f"{name} ≥ {value:g}" for name, value in wanted.at_least.items()),
        *(f"{name} ≤ {value:g}" for name, value in wanted.at_most.items()),
    ]
    return f"{wanted.event} with {', '.join(bounds)}" if bounds else wanted.event
