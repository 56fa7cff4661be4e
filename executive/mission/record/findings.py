"""What a mission reported about the site: figures, marks, stones, structures and saved maps."""

from typing import Any

from executive.events.finding import FigureReported, MapSaved, Marked, StonesListed
from executive.events.site import BuildingEnded
from executive.journal import Entry


class Findings:
    """Follows a journal; the newest figure of a name and the newest list of stones count."""

    def __init__(self) -> None:
        self._figures: dict[str, FigureReported] = {}
        self._marks: list[tuple[float, Marked]] = []
        self._stones: StonesListed | None = None
        self._maps: dict[str, MapSaved] = {}
        self._structures: dict[str, BuildingEnded] = {}

    def add(self, entry: Entry) -> None:
        """Take one entry."""
        match entry.event:
            case FigureReported() as event:
                self._figures[event.name] = event
            case Marked() as event:
                self._marks.append((entry.time_s, event))
            case StonesListed() as event:
                self._stones = event
            case MapSaved() as event:
                self._maps[event.file] = event
            case BuildingEnded() as event:
                self._structures[event.structure] = event

    def as_report(self) -> dict[str, Any]:
        """Return the entries of the report."""
        return {
            "figures": {
                name: {"value": one.value, "unit": one.unit} for name, one in self._figures.items()
            },
            "marks": [{"time_s": time_s, **mark.payload()} for time_s, mark in self._marks],
            "stones": list(self._stones.stones) if self._stones is not None else [],
            "maps": [one.payload() for one in self._maps.values()],
            "structures": [one.payload() for one in self._structures.values()],
        }
