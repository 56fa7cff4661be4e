"""The record of a run: entries, chained by checksums, in files that rotate.

Reading a journal needs the classes of its events; importing their modules registers them.
"""

from executive.events import control, driving, fault, finding, mission, node, site, stone, watch
from executive.journal.entry import Entry
from executive.journal.journal import Journal
from executive.journal.reading import JournalFile, read_journal

EVENT_MODULES = (mission, node, site, stone, driving, finding, fault, watch, control)

__all__ = ["EVENT_MODULES", "Entry", "Journal", "JournalFile", "read_journal"]
