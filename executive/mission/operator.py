"""The operator: asked on the terminal, or replaced by an option or the node's default."""

import sys
import threading
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


class TerminalQuestion(Question):
    """A question on the terminal; a thread waits for the line, the tick goes on."""

    def __init__(
        self,
        question: str,
        default: Answer,
        read_line: Callable[[], str],
        choices: Sequence[str] = (),
    ) -> None:
        self._answer: Answer = None
        self._default = default
        self._choices = choices
        self._read_line = read_line
        self._source = "operator"
        self._prompt = f"{question} {_hint(default, choices)} "
        threading.Thread(target=self._wait, name="operator", daemon=True).start()

    def answer(self) -> Answer:
        return self._answer

    def source(self) -> str:
        return self._source

    def _wait(self) -> None:
        while self._answer is None:
            sys.stderr.write(self._prompt)
            sys.stderr.flush()
            line = self._read_line()
            if not line:  # the terminal was closed
                self._source = "default"
                nothing = "" if self._choices else False
                self._answer = nothing if self._default is None else self._default
                return
            word = line.strip().lower()
            self._answer = self._understood(word) if word else self._default

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
    ) -> None:
        """Take the answers that were given beforehand.

        Args:
            preset: The answer to every question of yes or no.
            read_line: How a line of the terminal is read.
            chosen: Choices; a question takes the first of them that it offers.
        """
        self._preset = preset
        self._chosen = tuple(chosen)
        has_terminal = sys.stdin is not None and sys.stdin.isatty()
        self._read_line = read_line or (sys.stdin.readline if has_terminal else None)

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
        if self._read_line is not None:
            return TerminalQuestion(question, default, self._read_line, choices)
        if default is not None:
            return Answered(default, "default")
        cure = f"--answer {'|'.join(choices or ('yes', 'no'))} or a default"
        raise ConfigError(f"no one can answer '{question}': there is no terminal; give {cure}")
