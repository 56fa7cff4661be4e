"""Mark a region with a text."""

import numpy as np
from pydantic import Field

from executive.config import Settings
from executive.events.finding import Marked
from executive.interfaces.mapping import Mapper
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.region_name import RegionName
from executive.messages.mark import Mark


class MarkRegionSettings(Settings):
    region: RegionName = Field(examples=["corridor"], description="Name of a region.")
    text: str = Field(min_length=1, examples=["clear"], description="What is said about it.")


class MarkRegion(Condition[MarkRegionSettings]):
    """Mark a region of the mission with a text: in the viewer, the journal and the report.

    The mark stands at the median height of what the map shows in the region; fails if the map shows
    nothing there.
    """

    needs = (Mapper,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        """Record the mark and show it."""
        name, text = self.settings.region, self.settings.text
        region, points = self.context.region(name), self.context.use(Mapper).cloud().points
        seen = points[region.contains(points)]
        if not len(seen):
            return failed(f"the map shows nothing of the region '{name}': scan it first")
        middle = np.append(region.corners_map.mean(axis=0), np.median(seen[:, 2]))
        self.context.record(Marked(text, "region", middle, region=name))
        self.context.show(f"marks/{name}", Mark(text, middle))
        return succeeded(reason=f"{name}: {text}")
