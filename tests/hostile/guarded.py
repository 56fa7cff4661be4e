"""Damaged files read in a child that is replaced when it crashes or hangs."""

import json
import os
import resource
import select
import signal
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.hostile.formats import FORMATS, Format, Sample
from tests.hostile.trial import Answer, attempt, damaged_content

_GUARD_BYTES = 4_000_000_000  # of memory: more is a crash
_GUARD_S = 120.0  # on the wall: more is a hang


@dataclass(frozen=True, slots=True)
class Ended:
    """A child that crashed, or was killed because it hung."""

    outcome: str
    text: str


def answers(
    name: str, seed: int, numbers: Sequence[int]
) -> Iterator[tuple[int, bytes, Answer | Ended]]:
    """Yield the number, the content and what came of each file."""
    kind, place = FORMATS[name], (list(FORMATS).index(name), seed)
    with tempfile.TemporaryDirectory() as folder:
        samples = list(kind.make(Path(folder)))
        good = [one.file.read_bytes() for one in samples]
        for one in samples:
            kind.read(one.target)  # raises if a good file is refused
        left = list(numbers)
        while left:
            for number, answer in _child(kind, samples, good, place, tuple(left)):
                which = number % len(samples)
                yield number, damaged_content(kind, good[which], (*place, number)), answer
                left.remove(number)


def _child(
    kind: Format,
    samples: Sequence[Sample],
    good: Sequence[bytes],
    key: tuple[int, int],
    numbers: Sequence[int],
) -> Iterator[tuple[int, Answer | Ended]]:
    """Yield answers until all numbers are done or the child has ended."""
    mine, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(mine)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_DATA, (_GUARD_BYTES, _GUARD_BYTES))
        status = 1
        try:
            for number in numbers:
                which = number % len(samples)
                content = damaged_content(kind, good[which], (*key, number))
                answer = attempt(kind, samples[which], content)
                samples[which].file.write_bytes(good[which])
                os.write(theirs, json.dumps(asdict(answer)).encode()[:60_000] + b"\n")
            status = 0
        finally:
            os._exit(status)
    os.close(theirs)
    done = 0
    with os.fdopen(mine, "rb", buffering=0) as answered:
        while done < len(numbers):
            is_late = not select.select([answered], [], [], _GUARD_S)[0]
            line = b"" if is_late else answered.readline()
            if not line:
                break
            yield numbers[done], Answer(**json.loads(line))
            done += 1
        if done < len(numbers):
            os.kill(child, signal.SIGKILL)
    ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if done < len(numbers):
        outcome = "hang" if is_late else "crash"
        yield numbers[done], Ended(outcome, f"the child ended with {ended}")
