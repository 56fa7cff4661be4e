"""Computes verbs in worker processes, one for each capability."""

import multiprocessing as mp
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from executive import registry
from executive.events.mission import WorkerReplaced
from executive.mission.assembly import Selections, machine_of, needed_for
from executive.mission.jobs.limits import DEFAULT, Limits
from executive.mission.jobs.runner import InlineRunner, Task
from executive.mission.jobs.serving import serve
from executive.mission.jobs.thread_runner import BesideTick, OneThread
from executive.mission.jobs.worker import Worker
from executive.tree.instances import capability_of


class ProcessRunner(InlineRunner):
    """One worker process a stateless plugin; plugins with state are computed inline.

    Verbs that those name for it are computed in a thread a plugin, and what another process
    computes already is awaited in another one.

    Worker processes are forked from a server process that has imported the plugins' modules, and
    nothing more: a worker that has to be replaced is there at once, and shares their memory.
    """

    def __init__(
        self,
        selections: Selections,
        model: str,
        seed: int,
        limits: Limits = DEFAULT,
        tell: Callable[[WorkerReplaced], None] = lambda _: None,
    ) -> None:
        self._selections = selections
        self._workers: dict[str, Worker] = {}
        self._waiting, self._beside = OneThread(), BesideTick()
        machine = machine_of(selections, model)
        self._make: Callable[[str], Worker] = lambda capability: Worker(
            capability, needed_for(selections, capability), machine, seed, limits, tell
        )

    def submit(self, task: Task) -> Future[Any]:
        if task.is_awaited:
            return self._waiting.submit(task)
        if task.is_beside:
            return self._beside.submit(task)
        if not task.plugin.is_stateless:
            return super().submit(task)
        return self._worker(task.address.capability).submit(task)

    def prepare(self, capability: str) -> Future[Any] | None:
        return self._worker(capability).prepare()

    def abandon(self, task: Task, future: Future[Any]) -> None:
        worker = self._workers.get(task.address.capability)
        if worker is not None:
            worker.abandon(future)

    def close(self) -> None:
        self._waiting.close()
        self._beside.close()
        for worker in self._workers.values():
            worker.close()

    def _worker(self, capability: str) -> Worker:
        if not self._workers:
            modules = _modules(self._selections)
            mp.get_context("forkserver").set_forkserver_preload(
                ["__main__", serve.__module__, *modules]
            )
        if capability not in self._workers:
            self._workers[capability] = self._make(capability)
        return self._workers[capability]


def _modules(selections: Selections) -> list[str]:
    """Return the modules of the plugins that a worker may have to make, in order."""
    modules: dict[str, None] = {}
    for key, several in selections.items():
        if any(registry.load(capability_of(key), one.name).is_stateless for one in several):
            for needed, chosen in needed_for(selections, key).items():
                group = capability_of(needed)
                for plugin in (registry.load(group, one.name) for one in chosen):
                    modules |= dict.fromkeys((plugin.__module__, *plugin.late_imports))
    return list(modules)
