"""A chart with its name, on a page and as a PNG file."""

import re
from dataclasses import dataclass
from pathlib import Path

from executive.campaign.reporting.charts.spec import Spec, as_picture

_SCALE = 2.0  # pixels a unit of length: sharp on paper and on dense screens


@dataclass(frozen=True, slots=True)
class Picture:
    """A chart.

    Attributes:
        name: Name of its file, without the ending.
        title: What it shows.
        spec: Its Vega-Lite specification with its data.
    """

    name: str
    title: str
    spec: Spec

    def write(self, folder: Path) -> Path:
        """Draw it into a folder as PNG, and return the file."""
        import vl_convert

        path = folder / f"{re.sub(r'[^A-Za-z0-9_-]+', '-', self.name)}.png"
        drawn = vl_convert.vegalite_to_png(as_picture(self.spec, self.title), scale=_SCALE)
        path.write_bytes(drawn)
        return path
