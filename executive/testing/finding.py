"""The outcome of one check of one plugin, and where a failure comes from."""

from dataclasses import asdict, dataclass
from enum import StrEnum


class Outcome(StrEnum):
    """How a check ended; a check that could not be made is skipped, with its reason."""

    PASS = "pass"
    FAIL = "fail"
    SKIP = "skip"


@dataclass(frozen=True, slots=True)
class Finding:
    """One check.

    Attributes:
        check: What was checked, in words.
        outcome: How it ended.
        reason: Why it failed or was skipped, on one line; empty if it passed.
        place: `file:line` of a failure: in the plugin's code where the plugin raised it, else where
            its class begins; empty otherwise.
        duration_s: Wall time of the check [s].
    """

    check: str
    outcome: Outcome
    reason: str
    place: str
    duration_s: float

    def as_json(self) -> dict[str, str | float]:
        """Return the finding as JSON holds it."""
        return {**asdict(self), "outcome": self.outcome.value}

    def line(self) -> str:
        """Return the check as one line for people."""
        told = f"{self.outcome.upper():4}  {self.check}"
        where = f" ({self.place})" if self.place else ""
        return f"{told}{where}: {self.reason}" if self.reason else told


def words(test_id: str) -> str:
    """Return a check's name from its function's name and its parameter.

    >>> words("test_a_hostile_input_gives_a_value_or_a_refusal[one point-mine]")
    'a hostile input gives a value or a refusal [one point]'
    """
    function, _, parameter = test_id.removeprefix("test_").partition("[")
    cases = [case for case in parameter.rstrip("]").rsplit("-", 1)[:-1] if case]
    return " ".join([function.replace("_", " "), *(f"[{case}]" for case in cases)])
