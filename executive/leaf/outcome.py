"""The result of a leaf: success with its outputs, or failure with a reason."""

from dataclasses import dataclass
from typing import Generic, Never, TypeVar, overload

Result = TypeVar("Result")
Result_co = TypeVar("Result_co", covariant=True)


@dataclass(frozen=True, slots=True)
class Outcome(Generic[Result_co]):
    """Success with outputs, or failure with a reason that a person understands.

    Attributes:
        success: Whether the leaf did what its name says.
        reason: Why it failed; for a success, a remark worth showing.
        outputs: The typed result, whose fields are the leaf's output ports; None for none.
        is_final: A failure whose cause cannot change by repetition: nothing retries it.
    """

    success: bool
    reason: str = ""
    outputs: Result_co | None = None
    is_final: bool = False


@overload
def succeeded(*, reason: str = "") -> Outcome[None]: ...
@overload
def succeeded(outputs: Result, reason: str = "") -> Outcome[Result]: ...
def succeeded(outputs: object = None, reason: str = "") -> Outcome[object]:
    """Return a success, with the leaf's result if it has one."""
    return Outcome(True, reason, outputs)


@overload
def failed(reason: str, *, is_final: bool = False) -> Outcome[Never]: ...
@overload
def failed(reason: str, outputs: Result, *, is_final: bool = False) -> Outcome[Result]: ...
def failed(reason: str, outputs: object = None, *, is_final: bool = False) -> Outcome[object]:
    """Return a failure; outputs are written all the same, so that a recovery can read them.

    Args:
        reason: What stood in the way, for a person.
        outputs: What is known in spite of the failure.
        is_final: The same attempt must fail again, as for a stone that is too heavy; `retry` does
            not repeat it.
    """
    return Outcome(False, reason, outputs, is_final)
