"""An action that was cut off is redone, verified, failed, or decided about by the operator."""

from types import SimpleNamespace

import pytest

from executive.events.node import QuestionAnswered
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.tree.taking_up import taken_up

NODE = "main/0:lift"


class Leaf:
    """Answers which of its methods was asked, with the input that it was given."""

    def __init__(self, policy, outputs=()):
        self._policy = policy
        self.outputs = {
            name: SimpleNamespace(optional=name.startswith("maybe")) for name in outputs
        }

    def resumes(self):
        return self._policy

    def run(self, angle):
        yield "running"
        return succeeded(reason=f"ran to {angle}")

    def verify(self, angle):
        yield "verifying"
        return succeeded(reason=f"verified {angle}")


class Question:
    """Open until it was asked so often."""

    def __init__(self, answer, polls=2):
        self._answer, self._polls = answer, polls

    def answer(self):
        self._polls -= 1
        return None if self._polls >= 0 else self._answer

    def source(self):
        return "option"


class Runtime:
    def __init__(self, answer=None, has_memory=True):
        self.asked, self.events, self.policies = [], [], []
        self._question = Question(answer)
        self.memory = None
        if has_memory:
            self.memory = SimpleNamespace(taken_up=lambda *told: self.policies.append(told))

    def ask(self, *put):
        self.asked.append(put)
        return self._question

    def record(self, node, event):
        self.events.append((node, event))


def ended(leaf, runtime):
    """Run to the end; return what was yielded on the way, and the outcome."""
    yielded, steps = [], taken_up(leaf, {"angle": 1.5}, NODE, runtime)
    while True:
        try:
            yielded.append(next(steps))
        except StopIteration as end:
            return yielded, end.value


@pytest.mark.parametrize(
    ("policy", "yielded", "outcome"),
    [
        (OnResume.REDO, ["running"], succeeded(reason="ran to 1.5")),
        (OnResume.VERIFY, ["verifying"], succeeded(reason="verified 1.5")),
        (OnResume.FAIL, [], failed("it was under way when the run was cut off")),
    ],
)
def test_a_leaf_is_taken_up_as_its_class_declares_which_is_kept(policy, yielded, outcome):
    runtime = Runtime()
    assert ended(Leaf(policy), runtime) == (yielded, outcome)
    assert runtime.policies == [(NODE, policy)]
    assert (runtime.asked, runtime.events) == ([], [])
    assert ended(Leaf(policy), Runtime(has_memory=False)) == (yielded, outcome)


@pytest.mark.parametrize(
    ("answer", "yielded", "outcome"),
    [
        ("done", [], succeeded(reason="done, as option answered after the run was cut off")),
        ("fail", [], failed("fail, as option answered after the run was cut off")),
        ("redo", ["running"], succeeded(reason="ran to 1.5")),
    ],
)
def test_the_operator_decides_where_the_class_says_so(answer, yielded, outcome):
    runtime = Runtime(answer)
    assert ended(Leaf(OnResume.ASK), runtime) == ([None, None, *yielded], outcome)
    text = "main/0:lift was under way when the run was cut off. What is to become of it?"
    assert runtime.asked == [(NODE, text, "fail", ("done", "redo", "fail"))]
    ((node, event),) = runtime.events
    expected = QuestionAnswered(text, answer, "option").payload()
    assert (node, event.kind, event.payload()) == (NODE, "question_answered", expected)


@pytest.mark.parametrize(
    ("outputs", "choices"),
    [
        ((), ("done", "redo", "fail")),
        (("maybe_mass",), ("done", "redo", "fail")),
        (("mass", "maybe_mass"), ("redo", "fail")),
    ],
)
def test_a_leaf_that_owes_an_output_cannot_be_called_done(outputs, choices):
    runtime = Runtime("redo")
    ended(Leaf(OnResume.ASK, outputs), runtime)
    assert runtime.asked[0][3] == choices
