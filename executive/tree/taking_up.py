"""An action that was under way when its run was cut off is taken up as its class declares."""

from collections.abc import Mapping
from typing import Any

from executive.events.node import QuestionAnswered
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.runtime import Runtime

_DONE, _REDO, _FAIL = "done", "redo", "fail"


def taken_up(
    leaf: Action[Any], inputs: Mapping[str, Any], node: str, runtime: Runtime
) -> Steps[Any]:
    """Return the steps that go on with a call; see `OnResume`."""
    policy = leaf.resumes()
    if runtime.memory is not None:
        runtime.memory.taken_up(node, policy)
    outcome: Outcome[Any] | None = None
    if policy is OnResume.VERIFY:
        return (yield from leaf.verify(**inputs))
    if policy is OnResume.FAIL:
        outcome = failed("it was under way when the run was cut off")
    elif policy is OnResume.ASK:
        outcome = yield from _asked(leaf, node, runtime)
    return outcome if outcome is not None else (yield from leaf.run(**inputs))


def _asked(leaf: Action[Any], node: str, runtime: Runtime) -> Any:
    """Ask the operator; return the answer of the call, or None if it is to be redone."""
    needs_outputs = any(not port.optional for port in leaf.outputs.values())
    choices = (_REDO, _FAIL) if needs_outputs else (_DONE, _REDO, _FAIL)
    text = f"{node} was under way when the run was cut off. What is to become of it?"
    question = runtime.ask(node, text, _FAIL, choices)
    while (answer := question.answer()) is None:
        yield None
    runtime.record(node, QuestionAnswered(text, answer, question.source()))
    if answer == _REDO:
        return None
    reason = f"{answer}, as {question.source()} answered after the run was cut off"
    return succeeded(reason=reason) if answer == _DONE else failed(reason)
