"""Coverage of a tree: which of its branches runs have taken, and how often."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from executive.coverage.branch import HALTED, Branch, Limb, branch_of
from executive.events.node import NodeStarted
from executive.journal import Entry


@dataclass(frozen=True, slots=True)
class CoveredRun:
    """A run that counts.

    Attributes:
        name: Its folder, or `seed 3`.
        is_dry: Its leaves were mocked.
        outcome: How it ended; empty if it was cut off.
        reason: Why it failed.
        ended_s: Mission time of its last entry [s].
    """

    name: str
    is_dry: bool
    outcome: str
    reason: str
    ended_s: float


class Tally:
    """Counts the branches that a run takes, entry by entry."""

    def __init__(self) -> None:
        self.taken: Counter[Branch] = Counter()
        self.ticked: Counter[str] = Counter()  # rounds of activity, by path

    def __call__(self, entry: Entry) -> None:
        """Count an entry of the journal."""
        if isinstance(entry.event, NodeStarted):
            self.ticked[entry.node] += 1
            return
        branch = branch_of(entry.node, entry.event)
        if branch is not None:
            self.taken[branch] += 1

    def add(self, other: "Tally") -> None:
        """Add what another run has taken."""
        self.taken.update(other.taken)
        self.ticked.update(other.ticked)


@dataclass(frozen=True, slots=True)
class Coverage:
    """Which branches of a tree runs have taken.

    Attributes:
        mission: Name of the mission.
        limbs: The nodes of its tree, parents first.
        runs: The runs.
        tally: What they have taken.
    """

    mission: str
    limbs: Sequence[Limb]
    runs: list[CoveredRun] = field(default_factory=list)
    tally: Tally = field(default_factory=Tally)

    def add(self, run: CoveredRun, tally: Tally) -> None:
        """Add a run."""
        self.runs.append(run)
        self.tally.add(tally)

    def count(self, branch: Branch) -> int:
        """Return how often a branch was taken."""
        return self.tally.taken[branch]

    def halted(self, limb: Limb) -> int:
        """Return how often a node was cancelled by its parent."""
        return self.tally.taken[Branch(limb.path, HALTED.value)]

    def is_ticked(self, limb: Limb) -> bool:
        """Return whether any run has ticked a node.

        A node that is asked anew at each tick is journalled when its result changes, without a
        start.
        """
        return (
            self.tally.ticked[limb.path] > 0
            or self.halted(limb) > 0
            or any(self.count(one) for one in limb.branches if one.path == limb.path)
        )

    def is_reached(self, limb: Limb) -> bool:
        """Return whether any run has ticked a node, or a modifier has left it out."""
        return self.is_ticked(limb) or any(self.count(one) for one in limb.branches)

    @property
    def branches(self) -> list[Branch]:
        """Return all branches of the tree."""
        return [branch for limb in self.limbs for branch in limb.branches]

    @property
    def never(self) -> list[Branch]:
        """Return the branches that no run has taken."""
        return [branch for branch in self.branches if not self.count(branch)]

    @property
    def percent(self) -> float:
        """Return the share of the branches that runs have taken [%]."""
        total = len(self.branches)
        return 100.0 if total == 0 else 100.0 * (total - len(self.never)) / total
