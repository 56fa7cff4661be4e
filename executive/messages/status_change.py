"""A change of an estimator's status."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StatusChange:
    """One change of an estimator's status.

    Attributes:
        stamp_s: Time of the measurement, or of its absence, that caused it [s].
        before: The status that ended.
        after: The status that began.
        reason: Why it changed, in words; empty if the estimator gives no reason.
    """

    stamp_s: float
    before: str
    after: str
    reason: str
