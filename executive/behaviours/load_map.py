"""Load a map from a file."""

import os
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field

from executive.config import Settings
from executive.errors import DataError
from executive.events.finding import MapLoaded
from executive.interfaces.mapping import Mapper
from executive.leaf.action import Action, Steps
from executive.leaf.map_file import read_map
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
        description="Whether its points are put into the map as if they had been seen there: the "
        "machine must stand where the map's frame was when it was saved.",
    )


@dataclass(frozen=True, slots=True)
class LoadedMap:
    """The cloud of a file.

    Attributes:
        loaded_map: Points in the frame that they were saved in; RegisterDroneMap brings a cloud of
            another frame into the map (`in: {survey: "{loaded_map}"}`).
    """

    loaded_map: Cloud


class LoadMap(Action[LoadMapSettings]):
    """Read a map that SaveMap wrote, or any other cloud; with `merge`, put it into the map."""

    needs = (Mapper,)
    on_resume = OnResume.REDO

    def run(self) -> Steps[LoadedMap]:
        yield None  # reading gets a tick of its own
        path = self._path()
        try:
            found = yield from self.context.job(read_map, path)
        except DataError as error:
            return failed(str(error))
        cloud = found.cloud
        if self.settings.merge and cloud.frame != _MAP_FRAME:
            return failed(
                f"{path} is in the frame '{cloud.frame}', not in the map's: register it instead of "
                "'merge'",
                is_final=True,
            )
        if self.settings.merge:
            yield from self.context.job(self.context.use(Mapper).add_surface, cloud.points)
        self.context.record(
            MapLoaded(self.settings.file, len(cloud), cloud.frame, self.settings.merge)
        )
        self.context.show("loaded_map", cloud)
        return succeeded(LoadedMap(cloud), f"{len(cloud)} points from {self.settings.file}")

    def _path(self) -> Path:
        inside = self.context.folder() / self.settings.file
        # Unlike that of a Path, this answers no for a name that is too long or holds a NUL.
        return inside if os.path.isfile(inside) else Path(self.settings.file)
