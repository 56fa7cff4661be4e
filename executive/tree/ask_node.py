"""The node `ask`: a question to the operator, with keys filled in."""

from py_trees.common import Status

from executive.events.node import QuestionAnswered
from executive.leaf.runtime import Question, Runtime
from executive.tree.expressions.template import filled
from executive.tree.node_kinds import Ask
from executive.tree.nodes import Controller, Steps
from executive.tree.wiring import Scope


class AskNode(Controller):
    """Asks the operator, and journals who answered.

    Without choices, yes is success and no is failure. With choices, any of them is success, and is
    written into a key.
    """

    def __init__(self, kind: Ask, name: str, path: str, runtime: Runtime, scope: Scope) -> None:
        super().__init__(name, path, runtime)
        self._kind = kind
        self._scope = scope
        self._text = ""
        self._question: Question | None = None

    @property
    def choices(self) -> tuple[str, ...]:
        """Return what can be answered; empty for yes and no."""
        return self._kind.choices

    def begin(self) -> None:
        self._question = None

    def cancel(self) -> None:
        self._question = None

    def proceed(self) -> Steps:
        yield from ()
        if self._question is None:
            self._text = filled(self._kind.question.parts, self._scope.store)
            self._question = self.runtime.ask(
                self.path, self._text, self._kind.default, self._kind.choices
            )
        answer = self._question.answer()
        if answer is None:
            self.feedback_message = f"asking: {self._text}"
            return Status.RUNNING
        source = self._question.source()
        self.record(QuestionAnswered(self._text, answer, source))
        if isinstance(answer, bool):
            self.feedback_message = f"{'yes' if answer else 'no'} ({source})"
            return Status.SUCCESS if answer else Status.FAILURE
        return self._chosen(answer, source)

    def _chosen(self, answer: str, source: str) -> Status:
        if not answer:
            self.feedback_message = "nobody chose: the terminal was closed, and there is no default"
            return Status.FAILURE
        if self._kind.answer is not None:
            self._scope.store.set(self._kind.answer.key, answer)
        self.feedback_message = f"{answer} ({source})"
        return Status.SUCCESS
