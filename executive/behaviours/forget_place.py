"""Remove a stone's place from the map before a scan shows where the stone is now."""

from pydantic import Field

from executive.config import Meters, Settings
from executive.events.stone import PlaceForgotten
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, succeeded
from executive.leaf.removal import remove_from_map


class ForgetPlaceSettings(Settings):
    removal_radius: Meters = Field(
        1.0, gt=0, le=3, description="Least radius that is removed from the map [m]."
    )


class ForgetPlace(Condition[ForgetPlaceSettings]):
    """Remove a stone that may have been pushed from the map; the database keeps it.

    Without this step, the map shows the stone twice after the next scan: the stone is found where
    it no longer is, or its model grows by the surface of both poses.
    """

    needs = (Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def check(self, stone: int) -> Outcome[None]:
        """Remove the place.

        Args:
            stone: Id of the stone.
        """
        known = self.context.use(ObjectDatabase).stone(stone)
        removed, put_back = remove_from_map(self.context, known, self.settings.removal_radius)
        self.context.record(PlaceForgotten(stone, removed, put_back))
        return succeeded()
