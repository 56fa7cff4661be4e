"""Kills a run with signal 9 at a chosen point, resumes it, and judges where the stones are.

A point is a line of the journal, a change of the database, or the end of a tick: a process of its
own runs the mission and kills itself there.
"""

import functools
import json
import os
import shutil
import signal
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import toy_site
from executive_plugins.objects.sqlite import SqliteObjects

from executive.mission.options import Options
from executive.mission.resume import resumed_run
from executive.mission.run import Run
from executive.tree.load import load_mission

KINDS = ("line", "change", "tick")
# From the robot, the stones of the database and the report to what is wrong.
Judge = Callable[[Any, Any, Any], list[str]]


@dataclass(frozen=True)
class Kill:
    """Where a run is killed: at the n-th point of a kind, from 1."""

    kind: str
    number: int

    @classmethod
    def drawn(cls, rng: np.random.Generator, whole: dict[str, int]) -> "Kill":
        """Draw a point of a whole run, each kind as often as the others."""
        kind = str(rng.choice(KINDS))
        return cls(kind, int(rng.integers(1, whole[kind] + 1)))


class Killer:
    """Counts points, and ends this process at one of them."""

    def __init__(self, kill: Kill | None) -> None:
        self._kill = kill
        self.counts = dict.fromkeys(KINDS, 0)

    def pass_by(self, kind: str) -> None:
        """Count a point."""
        self.counts[kind] += 1
        if self._kill == Kill(kind, self.counts[kind]):
            os.kill(os.getpid(), signal.SIGKILL)

    def watch(self, run: Run) -> None:
        """Count the lines of a run and the changes of its database.

        A run that has written its end record has ended, and is not resumed.
        """
        run._journal.follow(lambda entry: entry.kind == "mission_ended" or self.pass_by("line"))
        for verb in ("grasp", "release", "set_state", "observe"):
            self._count(verb)

    def _count(self, verb: str) -> None:
        own = getattr(SqliteObjects, verb)

        @functools.wraps(own)  # a job asks for a verb by its name
        def counted(objects: Any, *args: Any, **kwargs: Any) -> Any:
            result = own(objects, *args, **kwargs)
            self.pass_by("change")
            return result

        setattr(SqliteObjects, verb, counted)


def in_process(work: Callable[[], dict[str, Any]], answer: Path) -> dict[str, Any] | None:
    """Do some work in a process of its own; return its answer, or None if it was killed."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            sys.stderr = sys.stdout = answer.with_suffix(".out").open("a")
            answer.write_text(json.dumps(work()))
            status = 0
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            os._exit(status)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return None
    if status:
        return {"complaints": [answer.with_suffix(".out").read_text()[-2000:]], "counts": {}}
    return json.loads(answer.read_text())


def execute(run: Run, kill: Kill | None, judge: Judge) -> dict[str, Any]:
    """Run to the end, or to the kill; return what is wrong with the stones."""
    killer, judged = Killer(kill), []
    killer.watch(run)
    close, plugins = run._close, run._assembly.plugins

    def judge_and_close() -> None:
        if not judged:
            judged.append((plugins["robot"], plugins["objects"].stones()))
        close()

    run._close = judge_and_close
    result = run.execute(lambda mission: killer.pass_by("tick"))
    (robot, stones), report = judged[0], result.report
    return {"complaints": judge(robot, stones, report), "counts": killer.counts}


def trial(
    mission: Path,
    folder: Path,
    kills: list[Kill],
    seed: int = 1,
    judge: Judge = toy_site.complaints,
) -> dict[str, Any]:
    """Run a mission that is killed and resumed, and then goes on to its end."""
    shutil.rmtree(folder, ignore_errors=True)
    answer = folder.with_suffix(".json")
    options = Options(run_dir=folder, seed=seed)
    for number, kill in enumerate([*kills, None]):
        is_first = number == 0 or not (folder / "journal.jsonl").exists()

        def work(kill: Kill | None = kill, is_first: bool = is_first) -> dict[str, Any]:
            made = Run(load_mission(str(mission)), options) if is_first else resumed_run(folder)
            return execute(made, kill, judge)

        found = in_process(work, answer)
        if found is not None:  # it came to its end before the kill
            return {**found, "kills": number}
    raise AssertionError("the last run is not killed")
