"""Requests to a mission that runs, and its replies: one line of JSON each."""

import json
import pwd
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from executive.errors import DataError, did_you_mean

MOST_BYTES = 4096  # of a request: a path of a node and an answer, with room
_FIELDS = ("verb", "argument", "node")


class Verb(StrEnum):
    """What can be asked of a mission; docs/how-to/operate_a_mission.md says what each does."""

    PAUSE = "pause"
    RESUME = "resume"
    STOP = "stop"
    STEP = "step"
    SKIP = "skip"
    RETRY = "retry"
    ANSWER = "answer"
    RESET = "reset"
    STATUS = "status"


@dataclass(frozen=True, slots=True)
class Request:
    """One request.

    Attributes:
        verb: What is asked.
        argument: The answer of `answer`, the number of ticks of `step`, `on_failure` of `pause` and
            `resume`; empty for none.
        node: Path of the node that is meant; empty if there is only one that can be.
    """

    verb: Verb
    argument: str = ""
    node: str = ""

    def line(self) -> bytes:
        """Return it as it goes through the socket."""
        return json.dumps(asdict(self)).encode() + b"\n"

    @classmethod
    def read(cls, line: bytes) -> "Request":
        """Read one.

        Raises:
            DataError: If it is none; the message names what is wrong.
        """
        try:
            found = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise DataError("a request is one line of JSON") from error
        if not isinstance(found, dict) or not all(isinstance(one, str) for one in found.values()):
            raise DataError(f"a request is an object of texts: {', '.join(_FIELDS)}")
        for name in found:
            if name not in _FIELDS:
                raise DataError(f"a request has no field '{name}'{did_you_mean(name, _FIELDS)}")
        verb = found.get("verb", "")
        if verb not in set(Verb):
            raise DataError(f"unknown verb '{verb}'{did_you_mean(verb, list(Verb))}")
        return cls(Verb(verb), found.get("argument", ""), found.get("node", ""))


@dataclass(frozen=True, slots=True)
class Reply:
    """What became of a request.

    Attributes:
        is_done: It was taken; else `text` says why not.
        text: One line for a person.
        status: How the mission is, for `status`; else empty.
    """

    is_done: bool
    text: str
    status: Mapping[str, Any] = field(default_factory=dict)

    def line(self) -> bytes:
        """Return it as it goes through the socket."""
        return json.dumps(asdict(self), ensure_ascii=False).encode() + b"\n"

    @classmethod
    def read(cls, line: bytes) -> "Reply":
        """Read one.

        Raises:
            DataError: If it is none.
        """
        try:
            return cls(**json.loads(line))
        except (ValueError, TypeError) as error:
            raise DataError(f"the run's reply cannot be read: {line[:80]!r}") from error


@dataclass(frozen=True, slots=True)
class Person:
    """Who asks: the process at the other end of the socket, as the kernel names it.

    Attributes:
        uid: Number of the user.
        pid: Number of the process.
    """

    uid: int
    pid: int

    @property
    def user(self) -> str:
        """Return the user's name; the number if it has none."""
        try:
            return pwd.getpwuid(self.uid).pw_name
        except KeyError:
            return str(self.uid)
