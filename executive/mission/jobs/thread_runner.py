"""Computes verbs in a thread beside the tick."""

import contextlib
import threading
import time
from concurrent.futures import Future, InvalidStateError
from queue import SimpleQueue
from typing import Any

from executive.mission.jobs.patience import Patience
from executive.mission.jobs.processor_time import ready_s
from executive.mission.jobs.runner import InlineRunner, Runner, Task, noted
from executive.mission.jobs.stack import frames_of_thread, place_among
from executive.supervision.beacon import beacon

_Queue = SimpleQueue[tuple[Task, Future[Any]] | None]


class ThreadRunner(InlineRunner):
    """One thread for all stateless plugins; they share plugins, so no two verbs run at once.

    A plugin with state, such as a survey that looks at the simulated world, is computed inline,
    but for the verbs that it names for it: beside the tick it would see the world at no time in
    particular. Those have a thread of their plugin's own, so that a scan pair does not wait for a
    plan. What another process computes is only awaited here.
    """

    def __init__(self) -> None:
        self._shared, self._beside = OneThread(), BesideTick()

    def submit(self, task: Task) -> Future[Any]:
        if task.is_beside:
            return self._beside.submit(task)
        if task.plugin.is_stateless or task.is_awaited:
            return self._shared.submit(task)
        return super().submit(task)

    def close(self) -> None:
        self._beside.close()
        self._shared.close()


class BesideTick(Runner):
    """One thread for each capability whose plugin names verbs for it, and one for leaves' own."""

    def __init__(self) -> None:
        self._threads: dict[str, OneThread] = {}

    def submit(self, task: Task) -> Future[Any]:
        return self._threads.setdefault(task.address.capability, OneThread()).submit(task)

    def close(self) -> None:
        for thread in self._threads.values():
            thread.close()


class OneThread(Runner):
    """Computes one verb after the other, in the order in which they came.

    A thread whose verb is overdue cannot be ended: its call fails, and another thread serves the
    calls that follow.
    """

    def __init__(self) -> None:
        self._queue: _Queue = SimpleQueue()
        self._serving: threading.Thread | None = None

    def submit(self, task: Task) -> Future[Any]:
        if self._serving is None:
            self._begin()
        future: Future[Any] = Future()
        self._queue.put((task, future))
        return future

    def close(self) -> None:
        self._queue.put(None)

    def _begin(self) -> None:
        # A daemon: the end of the program does not wait for a verb that hangs.
        self._serving = threading.Thread(target=self._serve, name="jobs", daemon=True)
        self._serving.start()

    def _serve(self) -> None:
        while self._serving is threading.current_thread():
            queued = self._queue.get()
            if queued is None:
                return
            task, future = queued
            if future.set_running_or_notify_cancel():
                self._compute(task, future)

    def _compute(self, task: Task, future: Future[Any]) -> None:
        number = threading.get_ident()
        clock = time.pthread_getcpuclockid(number)
        native = threading.get_native_id()
        patience = task.patience(lambda: time.clock_gettime(clock), lambda: ready_s(thread=native))
        self._look_after(patience.limit_s, patience, task, future, number)
        with contextlib.suppress(InvalidStateError):  # the call was given up in the meantime
            try:
                with noted(task):
                    answer = task.call.of(task.plugin)
            except Exception as error:
                future.set_exception(error)
            else:
                future.set_result(answer)

    def _look_after(
        self, wait_s: float, patience: Patience, task: Task, future: Future[Any], number: int
    ) -> None:
        """Give a call up, after a time, if it is overdue then; else look again."""

        def look() -> None:
            if future.done():
                return
            if more_s := patience.more_s():
                self._look_after(more_s, patience, task, future, number)
            else:
                self._give_up(task, future, number, patience.told())

        timer = threading.Timer(wait_s, look)
        timer.daemon = True
        future.add_done_callback(lambda _: timer.cancel())
        timer.start()

    def _give_up(self, task: Task, future: Future[Any], number: int, reason: str) -> None:
        place, trace = place_among(frames_of_thread(number), task.plugin)
        beacon().end(id(task))
        with contextlib.suppress(InvalidStateError):  # it has ended at this very moment
            future.set_exception(task.overdue(reason, place, trace))
            self._begin()
