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
        """Return a cell's name for a row: the levels of the factors that have several.

        `title` names these factors.
        """
        return ", ".join(levels[factor] for factor in self._varied(levels)) or ALL_RUNS

    def words(self, levels: Mapping[str, str]) -> str:
        """Return a cell's name for a sentence: `count=7, estimation=dual_graph`."""
        varied = self._varied(levels)
        return ", ".join(f"{self._short(one)}={levels[one]}" for one in varied) or ALL_RUNS

    @property
    def title(self) -> str:
        """Return what the levels in a cell's name are levels of."""
        return ", ".join(self._short(one) for one in self._varied(self.factors)) or "cell"

    def _varied(self, levels: Mapping[str, object]) -> list[str]:
        return [factor for factor in levels if len(self.factors.get(factor, ())) != 1]

    def _short(self, name: str) -> str:
        """Return the last part of a factor's dotted name, or all of it if that is ambiguous."""
        tails = [_tail(other) for other in self.factors]
        return _tail(name) if tails.count(_tail(name)) <= 1 else name


def _tail(name: str) -> str:
    return name.removesuffix(".plugin").rpartition(".")[2]
