"""Look for all stones that are lost."""

from pydantic import Field

from executive.config import Meters
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.leaf.action import Action, Steps
from executive.leaf.lost import lost_stones
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.search import SearchSettings, search


class FindLostSettings(SearchSettings):
    radius: Meters = Field(
        6.0, gt=0, le=20, description="Distance from its last known place that is searched [m]."
    )


class FindLost(Action[FindLostSettings]):
    """Look in the newest map for each stone that fell or was not seen, and fail if one is missing.

    It costs nothing while no stone is lost, so it may follow every scan. A stone that is found lies
    on the ground, and keeps its identity.
    """

    needs = (Mapper, Segmenter, Registrar, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        missing = []
        sought = lost_stones(self.context)
        for stone in sought:
            found = yield from search(self.context, stone.id, self.settings)
            if not found.success:
                missing.append(stone.id)
        if missing:
            return failed(f"stones {missing} are lost")
        return succeeded(reason=f"{len(sought)} lost stones were found")
