"""Processes of this computer as the place where runs happen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from executive.campaign.execution.chosen_work import inputs_of
from executive.campaign.execution.isolation import Isolation
from executive.campaign.execution.pool import Lost, Pool
from executive.campaign.execution.processes.running import Running
from executive.campaign.trial import Outcome, Trial
from executive.clock import wall_s
from executive.errors import ExecutiveError

_POLL_S = 0.1  # how often limits are held


@dataclass(frozen=True, slots=True)
class _Begun:
    running: Running
    tries: int


class LocalPool(Pool):
    """A number of runs side by side on this computer."""

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._isolation = Isolation()
        self._begun: list[_Begun] = []
        self._raised: list[ExecutiveError] = []  # by runs, and not yet by `wait`

    @property
    def slots(self) -> int:
        return self._jobs

    def begin(self, trial: Trial, folder: Path, tries: int) -> None:
        folder.mkdir(parents=True)
        running = self._isolation.begin(trial, folder, inputs_of(trial))
        self._begun.append(_Begun(running, tries))

    def wait(self, timeout_s: float) -> Sequence[Outcome | Lost]:
        deadline_s = wall_s() + timeout_s
        while not (ended := self._ended()) and (left_s := deadline_s - wall_s()) > 0:
            self._isolation.wait(min(left_s, _POLL_S))
        return ended

    def _ended(self) -> list[Outcome | Lost]:
        ended: list[Outcome | Lost] = []
        for begun in tuple(self._begun):
            try:
                result = begun.running.poll()
            except ExecutiveError as error:
                self._begun.remove(begun)
                self._raised.append(error)
                continue
            if result is None:
                continue
            self._begun.remove(begun)
            if isinstance(result, Outcome):
                result = replace(result, tries=begun.tries)
            ended.append(result)
        if self._raised and not ended:  # what has ended is handed over first
            raise self._raised.pop(0)
        return ended

    def close(self) -> None:
        self._isolation.close()
        self._begun.clear()
