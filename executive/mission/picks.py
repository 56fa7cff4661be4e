"""The course of each relocation, read from the journal: attempts, placement, setting aside."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from executive.arrays import Float
from executive.events.event import Event
from executive.events.mission import MissionEnded, VerdictGiven
from executive.events.node import NodeRetried
from executive.events.stone import (
    AttemptStarted,
    GraspRecord,
    JawsClosedOnNothing,
    PlacementVerified,
    StoneLost,
    StoneNotLifted,
    StoneRealigned,
    StoneReleased,
    StoneSeenInJaws,
    StoneSetAside,
    StonesTakenUpAgain,
    StoneWeighed,
)
from executive.interfaces.oracle import Attempt
from executive.interfaces.report import AttemptReport, PickReport
from executive.messages.verdict import Trouble
from executive.mission.event_lines import hanging

_UNFINISHED, _PLACED, _RELEASED = "unfinished", "placed", "released, not verified"
NOT_LIFTED, SHIFTED = "not lifted", "shifted"


@dataclass(slots=True)
class Try:
    """One attempt at a stone, from the choice of its grasp to its end."""

    stone: int
    started_s: float
    grasp: GraspRecord
    centroid_map: tuple[float, float, float]
    ended_s: float
    outcome: str = _UNFINISHED
    reason: str = ""
    success: float | None = None  # that was expected of it


@dataclass(slots=True)
class Pick:
    """One relocation of one stone: all attempts at it, and how it ended."""

    stone: int
    is_verified: bool  # the mission asks where each stone is that it released
    tries: list[Try] = field(default_factory=list)
    released: StoneReleased | None = None
    estimated_pose: Float | None = None
    set_aside: str = ""
    verified: PlacementVerified | None = None  # of the newest release
    weighed: StoneWeighed | None = None
    lost: str = ""  # why the stone is not where it was set down

    @property
    def is_over(self) -> bool:
        """Return whether the stone was set down on its slot, or set aside."""
        return self.released is not None or bool(self.set_aside)

    @property
    def is_placed(self) -> bool:
        """Whether it was set down on a slot, and a look after the release has shown it there.

        A mission that does not look (no `VerifyPlacement`) has nothing but the release to go by.
        """
        is_missing = self.verified is not None and self.verified.seen == "unseen"
        is_doubtful = self.is_off or is_missing or self.is_unverified or bool(self.lost)
        return self.released is not None and not is_doubtful

    @property
    def is_unverified(self) -> bool:
        """Whether the mission ended between a release and the look that was to follow."""
        is_open = self.is_verified and self.verified is None
        return is_open and self.released is not None and not self.lost

    @property
    def is_off(self) -> bool:
        """Whether the stone was last seen off the place on which it was set down."""
        return self.verified is not None and self.verified.seen == "off"

    @property
    def is_unseen(self) -> bool:
        """Whether the stone was not seen after its release."""
        return self.verified is None or self.verified.seen == "unseen"

    @property
    def is_turn_unknown(self) -> bool:
        """Whether it is placed with another surface than it was found with, turned unseen."""
        return self.is_placed and self.verified is not None and not self.verified.turn_known

    def _outcome_of(self, one: Try) -> str:
        return _RELEASED if self.is_unverified and one.outcome == _PLACED else one.outcome

    def as_report(self) -> PickReport:
        """Return the entry of the report."""
        released, verified, weighed = self.released, self.verified, self.weighed
        estimated = released.estimated_pose if released is not None else None
        return PickReport(
            object=self.stone,
            attempts=tuple(
                AttemptReport(
                    t.grasp, self._outcome_of(t), t.reason, t.started_s, t.ended_s, t.success
                )
                for t in self.tries
            ),
            placed=self.is_placed,
            unverified=self.is_unverified,
            slot=released.slot if released is not None else None,
            planned_pose=released.planned_pose if released is not None else None,
            estimated_pose=estimated if self.estimated_pose is None else self.estimated_pose,
            set_aside=self.set_aside or None,
            seen=None if verified is None else verified.seen,
            off_m=None if verified is None else verified.off_m,
            tilt_rad=None if verified is None else verified.tilt_rad,
            turn_known=None if verified is None else verified.turn_known,
            mass_kg=None if weighed is None else round(weighed.mass_kg, 1),
            mass_std_kg=None if weighed is None else round(weighed.std_kg, 1),
        )


class Picks:
    """Collects picks from events, in the order of the journal.

    Args:
        are_verified: The mission asks where each stone is that it released.
    """

    def __init__(self, *, are_verified: bool = False) -> None:
        self._are_verified = are_verified
        self.all: list[Pick] = []
        self._newest: dict[int, Pick] = {}  # by stone
        self._current: Try | None = None

    def add(self, time_s: float, event: Event) -> None:
        """Take one event of the journal."""
        match event:
            case AttemptStarted():
                self.cut_off(time_s)
                x, y, z = (float(value) for value in event.centroid_map)
                self._current = Try(
                    event.stone, time_s, event.grasp, (x, y, z), time_s, success=event.success
                )
                self._pick_of(event.stone).tries.append(self._current)
            case JawsClosedOnNothing() | StoneNotLifted() | StoneSeenInJaws():
                self._take_hold(time_s, event)
            case VerdictGiven():
                self._take_verdict(time_s, event)
            case StoneReleased():
                self._end(time_s, _PLACED, "")
                pick = self._pick_released(event)
                pick.released, pick.lost, pick.verified = event, "", None
            case StoneSetAside():
                self._pick_of(event.stone).set_aside = event.reason
                self._explain(event.reason)
            case NodeRetried() | MissionEnded():
                self._explain(event.reason)
            case StoneRealigned() | StoneWeighed() | PlacementVerified() | StoneLost():
                self._learn(event)
            case StonesTakenUpAgain():
                for stone in event.stones:  # the pick goes on, and its tries before that count
                    self._newest[stone].set_aside = ""

    def cut_off(self, now_s: float) -> None:
        """End an attempt that nothing has ended: by the next one, or by the end of the run."""
        if self._current is not None and self._current.outcome == _UNFINISHED:
            self._current.ended_s = now_s

    def _explain(self, reason: str) -> None:
        """Take why an attempt has failed that no event of a stone has ended."""
        current = self._current
        if current is not None and current.outcome == _UNFINISHED and not current.reason:
            current.reason = reason

    def _pick_released(self, event: StoneReleased) -> Pick:
        """Return the pick of a release; one that was told twice around a crash is told once."""
        newest = self._newest.get(event.stone)
        released = None if newest is None else newest.released
        if newest is not None and released is not None and released.slot == event.slot:
            return newest
        return self._pick_of(event.stone)

    def _pick_of(self, stone: int) -> Pick:
        pick = self._newest.get(stone)
        if pick is None or pick.is_over:
            pick = self._newest[stone] = Pick(stone, self._are_verified)
            self.all.append(pick)
        return pick

    def _learn(self, event: StoneRealigned | StoneWeighed | PlacementVerified | StoneLost) -> None:
        """Take what became known of a released stone."""
        pick = self._newest.get(event.stone)
        match event:
            case _ if pick is None:
                pass
            case StoneRealigned():
                pick.estimated_pose = event.estimated_pose
            case StoneWeighed():
                pick.weighed = event
            case StoneLost():
                pick.lost = event.reason
            case PlacementVerified():
                self._verify(pick, event)

    def _verify(self, pick: Pick, event: PlacementVerified) -> None:
        """Take what was seen of a release: a stone that is to be corrected is not placed."""
        pick.verified = event
        if event.seen == "placed":
            pick.lost = ""
        if event.rule == "correct" and pick.tries:
            pick.released = None
            pick.tries[-1].outcome, pick.tries[-1].reason = event.seen, event.reason

    def _take_hold(
        self, time_s: float, event: JawsClosedOnNothing | StoneNotLifted | StoneSeenInJaws
    ) -> None:
        """Take how the jaws hold the stone; what is not carried on ends the attempt."""
        match event:
            case JawsClosedOnNothing():
                self._end(time_s, "empty", event.reason)
            case StoneNotLifted():
                self._end(time_s, NOT_LIFTED, hanging(event))
            case StoneSeenInJaws() if event.refused:
                self._end(time_s, SHIFTED, event.refused)

    def _take_verdict(self, time_s: float, event: VerdictGiven) -> None:
        current = self._current
        if current and current.outcome == Trouble.SLIP and event.trouble is not Trouble.SLIP:
            current.outcome = _UNFINISHED  # the slip was the begin of a fall
        self._end(time_s, event.trouble, event.detail)

    def _end(self, time_s: float, outcome: str, reason: str) -> None:
        if self._current is None:
            return
        self._current.ended_s = time_s
        if self._current.outcome == _UNFINISHED:  # the first cause counts, not what follows from it
            self._current.outcome, self._current.reason = outcome, reason


def attempts_from(picks: Iterable[Pick]) -> list[Attempt]:
    """Return all attempts in order of time, for the oracle."""
    tries = sorted((t for pick in picks for t in pick.tries), key=lambda t: t.started_s)
    return [Attempt(t.stone, t.started_s, t.ended_s, t.outcome, t.centroid_map) for t in tries]


def newest_releases(picks: Iterable[Pick]) -> Mapping[int, StoneReleased]:
    """Return each stone's last release, if its newest pick ended in one."""
    newest = {pick.stone: pick.released for pick in picks}
    return {stone: released for stone, released in newest.items() if released is not None}
