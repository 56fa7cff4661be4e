"""A campaign from a file, a mission with options, or the folder of an earlier campaign."""

from pathlib import Path

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.options import CampaignOptions, campaign_of
from executive.campaign.description.paths import Paths
from executive.campaign.description.reader import read_campaign
from executive.errors import did_you_mean
from executive.tree.catalogue import Catalogue, InstalledCatalogue
from executive.tree.document import read_file
from executive.tree.problem import Mark, MissionFileError, Problem, Problems
from executive.tree.reading import Reading
from executive.tree.sources import find, shipped_names, shown
from executive.tree.value import Table

FILE = "campaign.yaml"  # in the folder of a campaign: what was asked for, with absolute paths
_MISSION_KEYS = {"mission", "trees", "extends", "plugins"}


def load_campaign(
    what: str,
    options: CampaignOptions | None = None,
    command: str = "",
    catalogue: Catalogue | None = None,
) -> Campaign:
    """Load a campaign, and check it together with all its missions and settings.

    Args:
        what: A campaign file; the folder of an earlier campaign; a mission file, or the name of a
            shipped one.
        options: What the command line lays over it.
        command: The command line, for the report.
        catalogue: What can be chosen; all that is installed by default.

    Raises:
        MissionFileError: If there is any mistake; it holds all of them, with their places.
    """
    reading = Reading(catalogue or InstalledCatalogue(), Problems())
    table, folder = _table(what, reading)
    table = (options or CampaignOptions()).laid_over(table, reading)
    return read_campaign(table, Paths(folder), reading, command)


def load_asked(folder: Path, command: str = "") -> Campaign:
    """Return what the campaign in a folder reports, bounds and compares, without its trials.

    Its missions are not read, so that results can be reported where these are not, or have changed.

    Raises:
        MissionFileError: If the campaign's file there has a mistake.
    """
    reading = Reading(InstalledCatalogue(), Problems())
    table, _ = _table(str(folder), reading)
    return read_campaign(table, Paths(folder), reading, command, has_trials=False)


def is_campaign_folder(what: str) -> bool:
    """Return whether the folder of a campaign is meant, not a shipped mission of that name."""
    path = Path(what)
    try:
        return (path / FILE).is_file() or (path.is_dir() and what not in shipped_names())
    except (OSError, ValueError):  # a name that is too long, or holds a NUL
        return False


def _table(what: str, reading: Reading) -> tuple[Table, Path]:
    path = Path(what) / FILE if is_campaign_folder(what) else find(what)
    if path is None:
        near = did_you_mean(what, shipped_names())
        told = f"no campaign file, no mission file and no shipped mission of that name{near}"
        raise MissionFileError([Problem(Mark(what or "FILE"), told)])
    value = read_file(path, shown(path), reading.problems, "campaign")
    table = reading.table(value, "a campaign file") if value is not None else None
    if table is None:
        reading.problems.raise_errors()
        raise MissionFileError([Problem(Mark(shown(path)), "cannot be read")])
    if "campaign" not in table.entries and _MISSION_KEYS & table.entries.keys():
        return campaign_of(what), Path.cwd()
    return table, path.resolve().parent
