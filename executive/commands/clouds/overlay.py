"""What `register` and `align` share: a source, or each cloud of a folder, over one target."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from executive.clouds.coordinate_system import coordinate_system
from executive.clouds.file_cloud import Place
from executive.clouds.ply_writer import coloured_parts
from executive.clouds.reader import read_points
from executive.clouds.writer import write_cloud
from executive.commands.clouds.alignment_answer import alignment_answer, alignment_view, verdict
from executive.commands.clouds.crop import Crop
from executive.commands.clouds.folder import Batch, check_batch, each_of
from executive.commands.clouds.output import check_cloud_output
from executive.commands.clouds.view import check_view, recording_of, show
from executive.commands.console import answer, say
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud

Lay = Callable[[Cloud, Cloud], Alignment]  # of target and source


@dataclass(frozen=True, slots=True)
class Overlay:
    """A source that is to be laid over a target, and what is wanted of it.

    Attributes:
        source: The cloud that is moved, or a folder of clouds.
        target: The cloud that it is laid over.
        crop: Words of the area to look at in the target; None for all of it.
        crop_source: The same in the source, in its own coordinates.
        widest_m: Largest width of what is looked at of each cloud [m]; None for the usual one.
        out: File for both clouds, or folder for the answers of a folder.
        as_json: Whether to answer on standard output.
        is_shown: Whether to show the result.
    """

    source: Path
    target: Path
    crop: str | None
    crop_source: str | None
    widest_m: float | None
    out: Path | None
    as_json: bool
    is_shown: bool

    def check(self) -> None:
        """Refuse options that are wrong, before anything is read.

        Raises:
            ConfigError: If one is.
        """
        self._areas()
        if self.source.is_dir():
            check_batch(self.source, self.out, self.as_json, self.is_shown)
        else:
            check_cloud_output("--out", self.out, read=(self.source, self.target))
        check_view(self.is_shown)

    def run(self, lay: Lay, asked: Mapping[str, Any]) -> int:
        """Lay the source over the target, say and answer what was found, and return the status.

        Args:
            lay: Lays a source over a target.
            asked: The options that it depends on, as plain values.

        Returns:
            0 if the motion was accepted, else 1; of a folder 0 if that of each cloud was.

        Raises:
            DataError: If a cloud cannot be used, or no point is in the area.
            ConfigError: As `check`.
        """
        target = self._site(0, self.target, "target")
        crs = coordinate_system(self.target)
        if not self.source.is_dir():
            found = self._laid(lay, target, crs, self.source, self.out)
            if self.as_json:
                answer(found)
            return 0 if found["accepted"] else 1
        crops = {"crop": self.crop, "crop_source": self.crop_source, "widest": self.widest_m}
        all_asked = {**asked, "target": str(self.target.resolve()), **crops}
        batch = Batch(self.source, self.out, all_asked, "both", (self.target,))
        return each_of(batch, partial(self._laid, lay, target, crs))

    def _areas(self) -> tuple[Crop, Crop]:
        return Crop(self.crop), Crop(self.crop_source, "--crop-source")

    def _site(self, area: int, path: Path, name: str) -> Cloud:
        return self._areas()[area].of_site(path, name, read_points(path), self.widest_m)

    def _laid(
        self, lay: Lay, target: Cloud, crs: str, path: Path, out: Path | None
    ) -> dict[str, Any]:
        """Lay one source over the target, say and show what was found, and return the answer."""
        source = self._site(1, path, "source")
        found = lay(target, source)
        told = verdict(found, source.points, target.points)
        say(f"{path.name}: {told}" if self.source.is_dir() else told)
        if out and found.accepted:
            parts = [target.points, found.apply(source.points)]
            write_cloud(out, coloured_parts(parts, Place(crs)))
        if self.is_shown:
            show(recording_of(path, out), alignment_view(found, source.points, target.points))
        return {**alignment_answer(found), "crs": crs}
