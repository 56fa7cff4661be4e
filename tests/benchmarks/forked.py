"""Work that continues from the present state of this process, once for each item.

What was computed before, such as an estimator's first seconds of a log, is shared by all items
and changed by none of them.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")


def forked(work: Callable[[T], R], items: Iterable[T], jobs: int) -> Iterator[R]:
    """Yield the results in order of the items, each computed in a process forked from this one.

    Args:
        work: Computes a result that can be pickled.
        items: Its arguments.
        jobs: How many processes run at a time.

    Raises:
        RuntimeError: If a process ended without a result.
    """
    context = get_context("fork")
    running: deque[tuple[BaseProcess, Connection]] = deque()
    for item in items:
        receiver, sender = context.Pipe(duplex=False)
        process = context.Process(target=_send, args=(sender, work, item))
        process.start()
        sender.close()
        running.append((process, receiver))
        if len(running) >= jobs:
            yield _received(*running.popleft())
    while running:
        yield _received(*running.popleft())


def _send(sender: Connection, work: Callable[[T], R], item: T) -> None:
    sender.send(work(item))


def _received(process: BaseProcess, receiver: Connection) -> R:
    try:
        result: R = receiver.recv()
    except EOFError as error:
        raise RuntimeError("a process of the benchmark ended without a result") from error
    finally:
        process.join()
    return result
