"""How long tests take without any fault, and that they pass then."""

import threading
from collections.abc import Sequence

from mutants.tree_copy import TreeCopy


class RedWithoutFaultError(RuntimeError):
    """Tests fail, or do not end, without any fault: they could judge nothing."""


class Baseline:
    """Runs tests once without a fault, and derives from it how long they may take with one.

    Args:
        limit_s: How long tests may take without a fault.
    """

    def __init__(self, limit_s: float) -> None:
        self._limit_s = limit_s
        self._limits_s: dict[tuple[str, ...], float] = {}
        self._red: dict[tuple[str, ...], str] = {}
        self._lock = threading.Lock()

    def limit_s(self, copy: TreeCopy, tests: Sequence[str]) -> float:
        """Return a minute and three times what the tests take without a fault [s].

        Raises:
            RedWithoutFaultError: If they fail, or take too long.
        """
        key = tuple(tests)
        with self._lock:
            if key in self._red:
                raise RedWithoutFaultError(self._red[key])
            if key in self._limits_s:
                return self._limits_s[key]
        ran = copy.run(tests, self._limit_s)
        if not ran.is_green:
            why = "ran out of time" if ran.status is None else "failed"
            text = f"{' '.join(tests)} {why} without any fault: {ran.first_failure}\n{ran.output}"
            with self._lock:
                self._red[key] = text
            raise RedWithoutFaultError(text)
        with self._lock:
            self._limits_s[key] = 60.0 + 3.0 * ran.seconds
            return self._limits_s[key]
