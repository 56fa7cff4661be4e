"""A change of an estimator's status."""

from collections.abc import Sequence
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


def reason_of(account: Sequence[StatusChange], status: str) -> str:
    """Return why a status is the present one, by the newest change; empty if that does not say."""
    return account[-1].reason if account and account[-1].after == status else ""
