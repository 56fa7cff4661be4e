"""Give a stone up."""

from typing import Any

from pydantic import Field

from executive.config import Settings
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, succeeded
from executive.leaf.port import Port
from executive.messages.stone import StoneState


class SetAsideSettings(Settings):
    reason: str = Field(
        "every attempt failed", min_length=1, description="What the report says, then the cause."
    )


class SetAside(Condition):
    """Leave a stone where it lies and say so: it is not tried again."""

    Settings = SetAsideSettings
    needs = ("objects",)
    inputs = {"stone": Port(int, "id of the stone")}

    def check(self, **inputs: Any) -> Outcome:
        self.context.plugin("objects").set_state(
            inputs["stone"], StoneState.SET_ASIDE, self.context.now_s()
        )
        cause = self.context.last_failure()
        reason = f"{self.settings.reason}: {cause}" if cause else self.settings.reason
        self.context.note("set_aside", stone=inputs["stone"], reason=reason)
        return succeeded(f"stone {inputs['stone']} is set aside")
