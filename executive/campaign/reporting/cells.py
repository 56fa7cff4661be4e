"""Names of cells: short where the factors allow it, and always unambiguous."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

ALL_RUNS = "all runs"


@dataclass(frozen=True, slots=True)
class Cells:
    """Names the cells of a campaign.

    Attributes:
        factors: Levels by factor.
    """

    factors: Mapping[str, Sequence[str]]

    def name(self, levels: Mapping[str, str]) -> str:
        """Return a cell's name: the levels of the factors that have several.

        With one such factor it is the bare level.
        """
        varied = [factor for factor in levels if len(self.factors.get(factor, ())) != 1]
        if not varied:
            return ALL_RUNS
        if len(varied) == 1 and len(self.varied) == 1:
            return levels[varied[0]]
        return ", ".join(f"{self.factor(factor)}={levels[factor]}" for factor in varied)

    def factor(self, name: str) -> str:
        """Return the last part of a factor's dotted name, or all of it if that is ambiguous."""
        tails = [_tail(other) for other in self.factors]
        return _tail(name) if tails.count(_tail(name)) <= 1 else name

    @property
    def varied(self) -> tuple[str, ...]:
        """Return the factors with several levels."""
        return tuple(name for name, levels in self.factors.items() if len(levels) > 1)

    @property
    def title(self) -> str:
        """Return what a column of cells is called."""
        return self.varied[0] if len(self.varied) == 1 else "cell"


def _tail(name: str) -> str:
    parts = name.removesuffix(".plugin").split(".")
    return parts[-1]
