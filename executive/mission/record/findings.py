"""What a mission reported about the site: figures, marks, stones, structures and saved maps."""

from executive.events.finding import FigureReported, ListedStone, MapSaved, Marked, StonesListed
from executive.events.site import BuildingEnded
from executive.interfaces.report import FigureReport, MarkReport
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

    @property
    def figures(self) -> dict[str, FigureReport]:
        """Return the newest figure of each name."""
        return {name: FigureReport(one.value, one.unit) for name, one in self._figures.items()}

    @property
    def marks(self) -> tuple[MarkReport, ...]:
        """Return all marks in order of time."""
        return tuple(
            MarkReport(
                time_s=time_s,
                text=mark.text,
                kind_of_place=mark.kind_of_place,
                position_map=mark.position_map,
                stone=mark.stone,
                region=mark.region,
            )
            for time_s, mark in self._marks
        )

    @property
    def stones(self) -> tuple[ListedStone, ...]:
        """Return the newest list of stones; empty without one."""
        return () if self._stones is None else self._stones.stones

    @property
    def maps(self) -> tuple[MapSaved, ...]:
        """Return the maps that were saved, the newest of each file."""
        return tuple(self._maps.values())

    @property
    def structures(self) -> tuple[BuildingEnded, ...]:
        """Return what was built, the newest end of each structure."""
        return tuple(self._structures.values())
