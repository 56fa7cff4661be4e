"""Whether a file describes a campaign; it imports little, since every check of a mission asks."""

from executive.tree.document import read_file
from executive.tree.problem import Problems
from executive.tree.sources import find
from executive.tree.value import Table


def is_campaign_file(what: str) -> bool:
    """Return whether a file is one of a campaign, whatever mistakes it has."""
    path = find(what)
    value = read_file(path, what, Problems(), "campaign") if path is not None else None
    return isinstance(value, Table) and "campaign" in value.entries
