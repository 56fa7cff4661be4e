"""A hold: a watched condition is broken, and the mission waits until it holds again."""

from dataclasses import dataclass

import numpy as np

from executive.events.watch import MissionWentOn
from executive.geometry.pose import inverse
from executive.geometry.rotation import log_so3
from executive.messages.base_state import BaseState


@dataclass(frozen=True, slots=True)
class Hold:
    """Why and since when the mission is held.

    Attributes:
        reason: What is broken.
        since_s: Machine time at which it began [s].
        before: State estimate then.
    """

    reason: str
    since_s: float
    before: BaseState

    def ended(self, now_s: float, state: BaseState, reason: str) -> MissionWentOn:
        """Return the event of its end, with how far the estimate moved meanwhile."""
        moved = inverse(self.before.T_map_base) @ state.T_map_base
        return MissionWentOn(
            held_s=round(now_s - self.since_s, 6),
            reason=reason,
            moved_m=float(np.linalg.norm(moved[:3, 3])),
            turned_rad=float(np.linalg.norm(log_so3(moved[:3, :3]))),
        )
