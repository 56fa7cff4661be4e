"""Whether the estimated pose may be used: its status, its age and its covariance."""

import numpy as np

from executive.messages.base_state import BaseState
from executive.watch.rules import EstimateRule


def stale(state: BaseState, now_s: float, limit_s: float) -> str:
    """Return how old a state is, if that is more than its limit [s]; empty if it is not."""
    age_s = now_s - state.stamp_s
    return f"the estimate is {age_s:.2f} s old" if age_s > limit_s + 1e-6 else ""


def estimate_trouble(
    state: BaseState, now_s: float, limit_s: float, rule: EstimateRule, why: str = ""
) -> str:
    """Return why the estimate may not be used; empty if it may.

    Args:
        state: The newest state.
        now_s: The machine's time [s].
        limit_s: Largest age of a state [s].
        rule: Allowed statuses and standard deviations.
        why: Why the estimator gave it its status; empty if it does not say.
    """
    if state.status not in rule.status:
        return f"the estimate is {state.status}" + (f": {why}" if why else "")
    old = stale(state, now_s, limit_s)
    if old:
        return old
    std = np.sqrt(np.maximum(np.diag(state.covariance), 0.0))
    heading, position = float(std[:3].max()), float(std[3:].max())
    if position > rule.position_std:
        return f"the position is uncertain by {position:.2f} m"
    if heading > rule.heading_std:
        return f"the rotation is uncertain by {heading:.3f} rad"
    return ""
