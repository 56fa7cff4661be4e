"""When a fault is active: from a time on, from a node's start on, or by chance."""

import numpy as np
from pydantic import Field, model_validator

from executive.config import Seconds, Settings


class Timing(Settings):
    """When a fault begins, and how long it lasts."""

    at: Seconds | None = Field(None, ge=0, description="Mission time at which it begins [s].")
    node: str | None = Field(
        None, description="Name of a node; the fault begins when that node begins."
    )
    nth: int = Field(1, ge=1, description="Which start of the node counts.")
    after: Seconds = Field(0.0, ge=0, description="Time from the node's start to the fault's [s].")
    chance: float | None = Field(
        None, gt=0, le=1, description="Probability that it begins within a second."
    )
    lasts: Seconds | None = Field(
        None, gt=0, description="How long it lasts [s]; to the end of the mission if absent."
    )

    @model_validator(mode="after")
    def _check_begin(self) -> "Timing":
        given = [name for name in ("at", "node", "chance") if getattr(self, name) is not None]
        if len(given) != 1:
            told = " and ".join(given) or "none of them"
            raise ValueError(f"a fault begins by one of at, node and chance; got {told}")
        if self.node is None and (self.nth != 1 or self.after != 0.0):
            raise ValueError("nth and after count from the start of a node; give `node`")
        return self


class Schedule:
    """Decides at each tick whether a fault is active; equal seeds decide alike."""

    def __init__(self, timing: Timing, rng: np.random.Generator) -> None:
        self._timing, self._rng = timing, rng
        self._begins_s = timing.at
        self._starts = 0
        self._newest_s = 0.0

    def node_started(self, node: str, now_s: float) -> None:
        """Take the start of a node, by its path."""
        if self._timing.node is None or node.rpartition(":")[2] != self._timing.node:
            return
        self._starts += 1
        if self._starts == self._timing.nth:
            self._begins_s = now_s + self._timing.after

    def is_active(self, now_s: float) -> bool:
        """Return whether the fault is active at a mission time [s]; times do not fall."""
        if self._timing.chance is not None:
            self._draw(now_s)
        begins_s, lasts = self._begins_s, self._timing.lasts
        if begins_s is None or now_s < begins_s - 1e-9:
            return False
        return lasts is None or now_s < begins_s + lasts - 1e-9

    def _draw(self, now_s: float) -> None:
        """Draw whether a fault of chance begins in the time since the last draw."""
        passed_s, self._newest_s = now_s - self._newest_s, now_s
        lasts = self._timing.lasts
        is_over = self._begins_s is not None and lasts is not None
        is_free = self._begins_s is None or (
            is_over and now_s >= self._begins_s + (lasts or 0.0)  # one after the other
        )
        chance = 1.0 - (1.0 - (self._timing.chance or 0.0)) ** max(passed_s, 0.0)
        if passed_s > 0 and is_free and self._rng.random() < chance:
            self._begins_s = now_s
