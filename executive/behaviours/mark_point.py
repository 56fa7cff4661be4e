"""Mark a point with a text."""

import re

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.events.finding import Marked
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.mark import Mark

_NO_NAME = re.compile(r"\W+")  # what an entity of the viewer is not called


class MarkPointSettings(Settings):
    text: str = Field(min_length=1, examples=["soft ground"], description="What is said about it.")
    at: tuple[Meters, Meters, Meters] | None = Field(
        None,
        examples=[[5.0, 2.0, 0.0]],
        description="The point in the map [m]; by default where the gripper is.",
    )


class MarkPoint(Condition[MarkPointSettings]):
    """Mark a point of the map with a text: in the viewer, the journal and the report."""

    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        """Record the mark and show it."""
        at, text = self.settings.at, self.settings.text
        position = self.context.gripper()[:3, 3] if at is None else np.array(at)
        if not np.isfinite(position).all():
            return failed(f"no point to mark with '{text}': its coordinates are not finite")
        self.context.record(Marked(text, "point", position))
        self.context.show(f"marks/{_NO_NAME.sub('_', text)}", Mark(text, position))
        return succeeded(reason=text)
