"""Let the map forget where a stone was, before a scan shows where it is."""

from typing import Any

from pydantic import Field

from executive.config import Meters, Settings
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, succeeded
from executive.leaf.port import Port
from executive.leaf.removal import remove_from_map


class ForgetPlaceSettings(Settings):
    removal_radius: Meters = Field(
        1.0, gt=0, le=3, description="Least radius of what the map forgets [m]."
    )


class ForgetPlace(Condition):
    """Take a stone out of the map that may have been pushed; the database keeps it, and the next
    scan shows it anew.

    Without it, the map shows the stone twice after that scan: it is found again where it no longer
    lies, or its model grows by the surface of both poses.
    """

    Settings = ForgetPlaceSettings
    needs = ("mapping", "objects")
    inputs = {"stone": Port(int, "id of the stone")}

    def check(self, **inputs: Any) -> Outcome:
        stone = self.context.plugin("objects").stone(inputs["stone"])
        removed, put_back = remove_from_map(self.context, stone, self.settings.removal_radius)
        self.context.note(
            "place_forgotten", stone=stone.id, removed_points=removed, put_back_points=put_back
        )
        return succeeded()
