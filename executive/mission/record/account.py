"""The account of a run, kept while its journal is written: picks, counts, and newest failures.

It grows with the number of picks and of the tree's nodes, not with the length of the run.
"""

from collections import Counter
from collections.abc import Iterable

from executive.arrays import Float
from executive.events.event import Event
from executive.events.mission import MissionEnded, PluginFailed, VerdictGiven
from executive.events.node import (
    NodeEnded,
    NodeNotRetried,
    NodeResult,
    NodeRetried,
    NodeStarted,
)
from executive.events.site import (
    BuildingPlanned,
    PlaceNotFound,
    SiteScanned,
    SiteSegmented,
    SlotsFound,
    SurveyRegistered,
)
from executive.events.stone import (
    AttemptStarted,
    GraspsPlanned,
    JawsClosedOnNothing,
    PlacementVerified,
    StoneGrasped,
    StoneLost,
    StoneSetAside,
    StoneSoughtAgain,
)
from executive.interfaces.report import Counts
from executive.journal import Entry
from executive.messages.verdict import Trouble
from executive.mission.picks import Pick, Picks
from executive.mission.record.findings import Findings

# Why a structure has no place for a stone while it stands as it does.
_FOR_NOW = frozenset({"nothing_fits", "out_of_time"})


class Account:
    """Follows a journal.

    Attributes:
        last: The newest entry; None before the first.
        registered: The newest accepted registration of a survey.
        has_ended: The end of the mission was journalled.
        stones_found: Number of stones that the last segmentation found.
        findings: What the mission reported about the site.
        slots: Place of each slot that was found, by its number [m], shape (3,).

    Args:
        verifies: The mission asks where each stone is that it released (`VerifyPlacement`).
    """

    def __init__(self, *, verifies: bool = False) -> None:
        self.last: Entry | None = None
        self.registered: SurveyRegistered | None = None
        self.stones_found = 0
        self.has_ended = False
        self.findings = Findings()
        self.slots: dict[int, Float] = {}
        self._picks = Picks(are_verified=verifies)
        self._kinds: Counter[type[Event]] = Counter()
        self._troubles: Counter[Trouble] = Counter()
        self._trouble: Trouble | None = None  # of the present hold
        self.given_up: set[int] = set()  # stones that were set aside after a final failure
        self._is_final = False  # something was not tried again since the newest plan
        self._has_no_place = False  # the structure has none for the stone, as it stands
        self._known: set[int] = set()  # stones that were found on the site
        self._lost: set[int] = set()  # stones that were lost and not seen since
        self._accepted = 0
        self._corrected = 0  # releases after which the stone was to be picked again
        self._failures: dict[str, tuple[int, str]] = {}  # by node: number of the entry, reason
        self._begun: dict[str, int] = {}  # by node: number of the entry of its newest start
        self._first: dict[str, tuple[int, str]] = {}  # why first attempts failed, as `_failures`

    @classmethod
    def of(cls, entries: Iterable[Entry]) -> "Account":
        """Return the account of entries that were read."""
        account = cls()
        for entry in entries:
            account.add(entry)
        return account

    def add(self, entry: Entry) -> None:
        """Take one entry."""
        self.last, event = entry, entry.event
        self._kinds[type(event)] += 1
        self._picks.add(entry.time_s, event)
        self.findings.add(entry)
        self._follow_final(event)
        self._follow_sightings(event)
        self._follow_failures(entry)
        match event:
            case MissionEnded():
                self.has_ended = True
            case PlacementVerified(rule="correct"):
                self._corrected += 1
            case VerdictGiven():
                self._count(event.trouble)
            case AttemptStarted() | StoneGrasped():
                self._trouble = None
            case SiteSegmented():
                self.stones_found = len(event.stones)
            case SlotsFound():
                self.slots |= {one.slot: one.position_map for one in event.slots}
            case SurveyRegistered(accepted=True):
                self._accepted += 1
                self.registered = event

    def _follow_failures(self, entry: Entry) -> None:
        """Note starts, failures, and first attempts that failed."""
        match entry.event:
            case NodeStarted():
                self._begun[entry.node] = entry.sequence
            case NodeEnded(status=NodeResult.FAILURE, reason=reason):
                self._failures[entry.node] = entry.sequence, reason
            case NodeRetried(attempt=1, reason=reason):
                self._first[entry.node] = entry.sequence, reason

    def _follow_sightings(self, event: Event) -> None:
        """Note which stones were seen, and which were lost since."""
        match event:
            case StoneLost():
                self._lost.add(event.stone)
            case SiteSegmented(stones=seen) | StoneSoughtAgain(seen=seen):
                self._known |= set(seen)
                self._lost -= set(seen)

    def _follow_final(self, event: Event) -> None:
        """Note stones that are set aside for a cause that repetition cannot change."""
        match event:
            case NodeNotRetried():
                self._is_final = not self._has_no_place
            case PlaceNotFound():
                self._has_no_place = event.reason in _FOR_NOW
            case StoneSetAside():
                self.given_up |= {event.stone} if self._is_final else set()
                self._is_final = self._has_no_place = False
            case GraspsPlanned() | SiteSegmented() | BuildingPlanned():
                self._is_final = self._has_no_place = False

    def _count(self, trouble: Trouble) -> None:
        """Count one trouble a hold: a slip that ends in a fall is a fall."""
        if self._trouble not in (None, Trouble.SLIP) or trouble is self._trouble:
            return
        if self._trouble is not None:
            self._troubles[self._trouble] -= 1
        self._troubles[trouble] += 1
        self._trouble = trouble

    @property
    def ended_s(self) -> float:
        """Return the time of the newest entry [s]."""
        return self.last.time_s if self.last else 0.0

    def picks(self) -> list[Pick]:
        """Return all picks in the order in which they began.

        A stone that is moved again, after it was placed or set aside, is picked again.
        """
        self._picks.cut_off(self.ended_s)
        return self._picks.all

    @property
    def placed(self) -> int:
        """Return the number of stones that were set down on a slot, again counted again."""
        return sum(pick.is_placed for pick in self._picks.all)

    def last_failure(self, parent: str) -> str:
        """Return why a node under a path failed last, recoveries left out; empty if none did."""
        below = f"{parent}/"
        found = [
            failure
            for node, failure in self._failures.items()
            if node.startswith(below) and "@on_failure" not in node[len(below) :]
        ]
        return max(found)[1] if found else ""

    def first_failure(self, parent: str) -> str:
        """Return why the first attempt of the outermost `retry` under a path failed.

        Empty if there was only one attempt since the node of that path began.
        """
        begun, below = self._begun.get(parent, 0), f"{parent}/"
        found = [
            (node.count("/"), reason)
            for node, (sequence, reason) in self._first.items()
            if node.startswith(below)
            and sequence > begun
            and "@on_failure" not in node[len(below) :]
        ]
        return min(found)[1] if found else ""

    def counts(self) -> Counts:
        """Return the counts of the report."""
        picks, kinds, troubles = self.picks(), self._kinds, self._troubles
        placed = [pick for pick in picks if pick.is_placed]
        return Counts(
            picks=len(picks),
            placed=len(placed),
            attempts=sum(len(pick.tries) for pick in picks),
            first_attempt=sum(len(pick.tries) == 1 for pick in placed),
            slips=troubles[Trouble.SLIP],
            drops=troubles[Trouble.DROP],
            empty=kinds[JawsClosedOnNothing],
            set_aside=sum(bool(pick.set_aside) for pick in picks),
            known=len(self._known | {pick.stone for pick in picks}),
            untouched=len(self._known - {pick.stone for pick in picks if pick.tries}),
            off=sum(pick.is_off for pick in picks),
            unverified=sum(pick.is_unverified for pick in picks),
            turn_unknown=sum(pick.is_turn_unknown for pick in picks),
            unseen=sum(pick.is_unseen for pick in placed),
            lost=len(self._lost),
            corrected=self._corrected,
            registrations=kinds[SurveyRegistered],
            registrations_accepted=self._accepted,
            scans=kinds[SiteScanned],
            not_retried=kinds[NodeNotRetried],
            plugin_failures=kinds[PluginFailed],
        )
