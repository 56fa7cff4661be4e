"""The operator: asked on the terminal, or replaced by an option or the node's default."""

import sys
import threading
from collections.abc import Callable

from executive.errors import ConfigError
from executive.leaf.runtime import Question

_WORDS = {"yes": True, "y": True, "no": False, "n": False}


class Answered(Question):
    """A question that somebody has answered beforehand."""

    def __init__(self, answer: bool, source: str) -> None:
        self._answer = answer
        self._source = source

    def answer(self) -> bool | None:
        return self._answer

    def source(self) -> str:
        return self._source


class TerminalQuestion(Question):
    """A question on the terminal; a thread waits for the line, the tick goes on."""

    def __init__(self, question: str, default: bool | None, read_line: Callable[[], str]) -> None:
        self._answer: bool | None = None
        self._default = default
        self._read_line = read_line
        self._source = "operator"
        hint = {True: "[Y/n]", False: "[y/N]", None: "[y/n]"}[default]
        self._prompt = f"{question} {hint} "
        threading.Thread(target=self._wait, name="operator", daemon=True).start()

    def answer(self) -> bool | None:
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
                self._answer = bool(self._default)
                return
            word = line.strip().lower()
            self._answer = self._default if not word else _WORDS.get(word)


class Operator:
    """Puts questions: to the terminal if there is one and no answer was given beforehand."""

    def __init__(
        self, preset: bool | None = None, read_line: Callable[[], str] | None = None
    ) -> None:
        self._preset = preset
        has_terminal = sys.stdin is not None and sys.stdin.isatty()
        self._read_line = read_line or (sys.stdin.readline if has_terminal else None)

    def ask(self, question: str, default: bool | None) -> Question:
        """Return a question, answered or open.

        Raises:
            ConfigError: If no one can answer: no terminal, no `--answer`, no default in the node.
        """
        if self._preset is not None:
            return Answered(self._preset, "option")
        if self._read_line is not None:
            return TerminalQuestion(question, default, self._read_line)
        if default is not None:
            return Answered(default, "default")
        raise ConfigError(
            f"no one can answer '{question}': there is no terminal; give --answer "
            "yes|no or a default"
        )
