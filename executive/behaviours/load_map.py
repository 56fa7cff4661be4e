"""Load a map from a file."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import Field

from executive.config import Settings
from executive.errors import DataError
from executive.events.finding import MapLoaded
from executive.geometry.geodesy import T_enu_enu
from executive.geometry.pose import transform
from executive.interfaces.estimation import Estimator
from executive.interfaces.mapping import Mapper
from executive.leaf.action import Action, Steps
from executive.leaf.map_file import MapFile, read_map
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.messages.cloud import Cloud

_MAP_FRAME = "map"


class LoadMapSettings(Settings):
    file: str = Field(
        min_length=1,
        examples=["saved_map.ply"],
        description="Path of a cloud; relative to the run's folder or, if it is not there, to the "
        "folder in which the program was started.",
    )
    merge: bool = Field(
        False,
        description="Whether its points are put into the map as if they had been seen there. A map "
        "whose origin on the earth is not in its file is taken to have that of this mission.",
    )


@dataclass(frozen=True, slots=True)
class LoadedMap:
    """The cloud of a file.

    Attributes:
        loaded_map: Points in the map, if the file and the estimate tell where the origins of both
            are; else in the frame that they were saved in. RegisterDroneMap brings a cloud of
            another frame into the map (`in: {survey: "{loaded_map}"}`).
    """

    loaded_map: Cloud


class LoadMap(Action[LoadMapSettings]):
    """Read a map that SaveMap wrote, or any other cloud; with `merge`, put it into the map."""

    needs = (Mapper, Estimator)
    on_resume = OnResume.REDO

    def run(self) -> Steps[LoadedMap]:
        yield None  # reading gets a tick of its own
        path = self._path()
        try:
            found = yield from self.context.job(read_map, path)
        except DataError as error:
            return failed(str(error))
        cloud = self._in_map(found)
        if self.settings.merge and (why := self._foreign(found, cloud)):
            return failed(f"{path} {why}", is_final=True)
        if self.settings.merge:
            yield from self.context.job(self.context.use(Mapper).add_surface, cloud.points)
        self.context.record(
            MapLoaded(self.settings.file, len(cloud), cloud.frame, self.settings.merge)
        )
        self.context.show("loaded_map", cloud)
        return succeeded(LoadedMap(cloud), f"{len(cloud)} points from {self.settings.file}")

    def _in_map(self, found: MapFile) -> Cloud:
        """Return a map's cloud about the origin of this mission, where both origins are known."""
        origin = self.context.use(Estimator).map_origin
        if origin is None or found.datum is None or found.cloud.frame != _MAP_FRAME:
            return found.cloud
        T_map_file = T_enu_enu(np.array(origin), found.datum)
        return Cloud(_MAP_FRAME, transform(T_map_file, found.cloud.points))

    def _foreign(self, found: MapFile, cloud: Cloud) -> str:
        """Say why a cloud cannot be put into the map; empty if it can."""
        if cloud.frame != _MAP_FRAME:
            return (
                f"is in the frame '{cloud.frame}', not in the map's: register it instead of 'merge'"
            )
        if found.datum is None:
            return ""
        place = f"{found.datum[0]:.6f}°, {found.datum[1]:.6f}°, {found.datum[2]:.1f} m"
        if self.context.use(Estimator).map_origin is None:
            return f"is about {place}, and where this mission's map is is not known: Localise first"
        here, reach_m = self.context.state().T_map_base[:2, 3], self.context.machine().reach_m
        nearest_m = float(np.hypot(*(cloud.points[:, :2] - here).T).min())
        if nearest_m > reach_m:
            return (
                f"is about {place}: its nearest point is {nearest_m:.0f} m away, out of the "
                f"machine's reach of {reach_m:.1f} m"
            )
        return ""

    def _path(self) -> Path:
        inside = self.context.folder() / self.settings.file
        # Unlike that of a Path, this answers no for a name that is too long or holds a NUL.
        return inside if os.path.isfile(inside) else Path(self.settings.file)
