"""The operator: asked on the terminal or over the control socket, or replaced by an option or the
node's default.
"""

import sys
import threading
from collections import deque
from collections.abc import Callable, Sequence

from executive.errors import ConfigError
from executive.leaf.runtime import Question

_WORDS = {"yes": True, "y": True, "no": False, "n": False}
Answer = bool | str | None  # yes or no, one of the choices, or none yet


class Answered(Question):
    """A question that somebody has answered beforehand."""

    def __init__(self, answer: bool | str, source: str) -> None:
        self._answer = answer
        self._source = source

    def answer(self) -> Answer:
        return self._answer

    def source(self) -> str:
        return self._source


class OpenQuestion(Question):
    """A question that waits for a person, at the terminal or at the control socket."""

    def __init__(self, question: str, default: Answer, choices: Sequence[str] = ()) -> None:
        self._answer: Answer = None
        self._default = default
        self._choices = choices
        self._source = "operator"
        self.prompt = f"{question} {_hint(default, choices)} "

    def answer(self) -> Answer:
        return self._answer

    def source(self) -> str:
        return self._source

    def take(self, word: str, source: str = "operator") -> bool:
        """Take what a person says, an empty word for the default; return whether it answers."""
        word = word.strip().lower()
        understood = self._understood(word) if word else self._default
        if self._answer is None and understood is not None:
            self._source, self._answer = source, understood
            return True
        return False

    def give_up(self) -> None:
        """Take the default, and without one no or nothing: nobody can answer any more."""
        nothing = "" if self._choices else False
        self._source = "default"
        self._answer = nothing if self._default is None else self._default

    def _understood(self, word: str) -> Answer:
        """Return what a line means: yes or no; a choice by its number or how it begins."""
        if not self._choices:
            return _WORDS.get(word)
        if word.isdecimal() and 1 <= int(word) <= len(self._choices):
            return self._choices[int(word) - 1]
        exact = [choice for choice in self._choices if choice.lower() == word]
        begun = [choice for choice in self._choices if choice.lower().startswith(word)]
        meant = exact or begun
        return meant[0] if len(meant) == 1 else None


class Terminal:
    """Reads the lines of the terminal for the oldest question that is open.

    One thread reads for all questions: one that was answered elsewhere leaves no reader behind that
    would take the next question's line.
    """

    def __init__(self, read_line: Callable[[], str]) -> None:
        self._read_line = read_line
        self._questions: deque[OpenQuestion] = deque()
        self._change = threading.Condition()
        self._prompted: OpenQuestion | None = None  # that a line is being waited for
        self._has_begun = False

    def put(self, question: OpenQuestion) -> None:
        """Ask; the tick goes on."""
        with self._change:
            self._questions.append(question)
            if self._prompted is not None and self._open() is question:
                self._prompt(question)  # the thread waits for a line already
            self._change.notify()
        if not self._has_begun:
            self._has_begun = True
            threading.Thread(target=self._read, name="operator", daemon=True).start()

    def _read(self) -> None:
        while True:
            with self._change:
                self._change.wait_for(lambda: self._open() is not None)
                question = self._open()
                if question is not None:
                    self._prompt(question)
            line = self._read_line()
            with self._change:
                question, self._prompted = self._open(), None
            if question is not None and line:
                question.take(line)
            elif question is not None:  # the terminal was closed
                question.give_up()

    def _prompt(self, question: OpenQuestion) -> None:
        self._prompted = question
        sys.stderr.write(question.prompt)
        sys.stderr.flush()

    def _open(self) -> OpenQuestion | None:
        """Return the oldest open question, and forget those before it."""
        while self._questions and self._questions[0].answer() is not None:
            self._questions.popleft()
        return self._questions[0] if self._questions else None


def _hint(default: Answer, choices: Sequence[str]) -> str:
    if not choices:
        return "[y/n]" if default is None else "[Y/n]" if default else "[y/N]"
    numbered = ", ".join(f"{number} {choice}" for number, choice in enumerate(choices, 1))
    return f"[{numbered}{'' if default is None else f'; Enter for {default}'}]"


class Operator:
    """Puts questions: to the terminal if there is one and no answer was given beforehand."""

    def __init__(
        self,
        preset: bool | None = None,
        read_line: Callable[[], str] | None = None,
        chosen: Sequence[str] = (),
        *,
        is_attended: bool = False,
    ) -> None:
        """Take the answers that were given beforehand.

        Args:
            preset: The answer to every question of yes or no.
            read_line: How a line of the terminal is read.
            chosen: Choices; a question takes the first of them that it offers.
            is_attended: Without a terminal a question waits for the control socket.
        """
        self._preset = preset
        self._chosen = tuple(chosen)
        has_terminal = sys.stdin is not None and sys.stdin.isatty()
        read_line = read_line or (sys.stdin.readline if has_terminal else None)
        self._terminal = Terminal(read_line) if read_line is not None else None
        self._is_attended = is_attended

    def ask(self, question: str, default: Answer, choices: Sequence[str] = ()) -> Question:
        """Return a question, answered or open.

        Args:
            question: The text.
            default: What an empty line means, and what is taken when nobody can answer.
            choices: The answers to choose from; empty for yes and no.

        Raises:
            ConfigError: If no one can answer: no terminal, no `--answer`, no default in the node.
        """
        if self._preset is not None and not choices:
            return Answered(self._preset, "option")
        for choice in self._chosen:
            if choice in choices:
                return Answered(choice, "option")
        if self._terminal is not None or self._is_attended:
            open_question = OpenQuestion(question, default, choices)
            if self._terminal is not None:
                self._terminal.put(open_question)
            return open_question
        if default is not None:
            return Answered(default, "default")
        cure = f"--answer {'|'.join(choices or ('yes', 'no'))} or a default"
        raise ConfigError(
            f"no one can answer '{question}': there is no terminal; give {cure}, or "
            "--attended to wait for `executive ctl RUN answer`"
        )
