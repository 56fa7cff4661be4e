"""How a leaf that no file mocks ends: drawn, with probabilities that the command tells."""

import math
from dataclasses import dataclass

import numpy as np

# Durations of actions, and times for which an answer of a condition holds, are drawn with equal
# weight for each factor: from ten ticks to about a minute.
SHORTEST_S, LONGEST_S = 0.5, 50.0
YES = 0.5  # of a condition, and of a question of yes or no
HANGING = 0.5  # of the failing actions below a `timeout`: they do not end by themselves


@dataclass(frozen=True, slots=True)
class Chance:
    """The probabilities of a dry run.

    Attributes:
        seed: Seed of all that is drawn.
        failures: Probability that an action fails.
    """

    seed: int = 1
    failures: float = 0.1

    def told(self) -> str:
        """Return one sentence for people."""
        return (
            "drawn where no file says more: an action fails with probability "
            f"{self.failures:g} and takes {SHORTEST_S:g} to {LONGEST_S:g} s, a condition holds "
            f"with probability {YES:g}"
        )

    def fails(self, rng: np.random.Generator) -> bool:
        """Draw whether an action fails."""
        return bool(rng.random() < self.failures)

    def hangs(self, rng: np.random.Generator) -> bool:
        """Draw whether an action that fails below a timeout does not end by itself."""
        return bool(rng.random() < HANGING)

    def holds(self, rng: np.random.Generator) -> bool:
        """Draw the answer of a condition or of a question."""
        return bool(rng.random() < YES)

    def duration_s(self, rng: np.random.Generator, limit_s: float = math.inf) -> float:
        """Draw a duration [s]; of an action below a `timeout`, at most half of its limit.

        So that a timeout passes where an action hangs, and with no failures not at all.
        """
        longest_s = min(LONGEST_S, limit_s / 2)
        shortest_s = min(SHORTEST_S, longest_s)
        return math.exp(rng.uniform(math.log(shortest_s), math.log(longest_s)))
