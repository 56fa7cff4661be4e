"""Why stones and places are passed over in a search for the next stone."""

from collections import Counter
from collections.abc import Mapping, Sequence

from executive.messages.building import BuildPlan, BuildTarget, NoTarget


class Refusals:
    """Counts reasons, of all stones and of each one, in the order in which they were met.

    Attributes:
        total: Of all stones.
    """

    def __init__(self) -> None:
        self.total: Counter[str] = Counter()
        self._of: dict[str, Counter[str]] = {}

    def add(self, stone: str, reason: str, times: int = 1) -> None:
        """Count a stone, or places of it, that were passed over."""
        self.total[reason] += times
        self._of.setdefault(stone, Counter())[reason] += times

    def forget(self, reason: str) -> None:
        """Count a reason anew."""
        for counted in (self.total, *self._of.values()):
            counted.pop(reason, None)

    def why_none(self, offered: int, usable: int) -> NoTarget | None:
        """Return why no stone can be placed of so many that are offered and usable, if so."""
        if not offered:
            return "no_stones"
        if usable:
            return None
        return "all_too_heavy" if self.total["too_heavy"] == offered else "all_unsuitable"

    def without_target(self, reason: NoTarget, detail: str) -> BuildPlan:
        """Return the plan that has no target, for a reason."""
        return BuildPlan((), reason, dict(self.total), detail, self._by_stone())

    def plan(self, targets: Sequence[BuildTarget], tried: int) -> BuildPlan:
        """Return a plan: targets, or that none was found for as many stones."""
        if targets:
            return BuildPlan(tuple(targets), None, dict(self.total), "", self._by_stone())
        if "out_of_time" in self.total:
            return self.without_target("out_of_time", "no place held in the time given")
        return self.without_target("nothing_fits", f"no place holds any of {tried} stones")

    def _by_stone(self) -> Mapping[str, Mapping[str, int]]:
        return {stone: dict(counted) for stone, counted in self._of.items() if counted}
