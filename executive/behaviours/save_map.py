"""Save the map to a file."""

import numpy as np
from pydantic import Field

from executive.config import Settings
from executive.events.finding import MapSaved
from executive.interfaces.estimation import Estimator
from executive.interfaces.mapping import Mapper
from executive.leaf.action import Action, Steps
from executive.leaf.map_file import MapFile, write_map
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import map_cloud


class SaveMapSettings(Settings):
    file: str = Field(
        "saved_map.ply",
        pattern=r".+\.ply$",
        description="Name of the PLY file; relative to the run's folder.",
    )


class SaveMap(Action[SaveMapSettings]):
    """Write the map as it is now to a PLY file, and its frame and the machine's pose beside it.

    Where the frame's origin is on the earth stands there, too, as soon as the estimate knows it.
    `report.json` names the file; LoadMap reads it.
    """

    needs = (Mapper, Estimator)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        cloud = yield from map_cloud(self.context)
        if not len(cloud):
            return failed("the map is empty: scan first")
        yield None  # writing gets a tick of its own
        path = self.context.folder() / self.settings.file
        state, datum = self.context.state(), self.context.use(Estimator).map_origin
        origin = None if datum is None else np.array(datum)
        try:
            saved = MapFile(cloud, self.context.now_s(), state.T_map_base, origin)
            yield from self.context.job(write_map, path, saved)
        except OSError as error:
            return failed(f"{path} cannot be written: {error.strerror or error}")
        told = self.settings.file, len(cloud), cloud.frame, state.T_map_base, datum
        self.context.record(MapSaved(*told))
        return succeeded(reason=f"{len(cloud)} points in {self.settings.file}")
