"""`executive run --dry`: the tree of a mission with mocked leaves, once or with many seeds."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from executive.commands.console import answer, say

if TYPE_CHECKING:
    from executive.dry_run.rehearsal import Rehearsal

DEFAULT_FAILURES = 0.1
_SHOWN = 10  # runs, and made-up values, that are told one by one


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be run.

    Attributes:
        mission: The mission's file, or its name.
        settings: The values of `--set`.
        answers: The values of `--answer`.
        run_dir: Where journals are kept; None keeps none.
        mocks: The file of mocks.
    """

    mission: str
    settings: tuple[str, ...]
    answers: tuple[str, ...]
    run_dir: Path | None
    mocks: Path | None


@dataclass(frozen=True, slots=True)
class Draws:
    """What is drawn: the first seed, the number of runs, the probability that an action fails."""

    seed: int
    runs: int
    failures: float


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is told.

    Attributes:
        at_least: The share of the branches below which the exit status is 1 [%]; None for no bound.
        by_tree: Whether the calls of one tree count together.
        quiet: Whether the nodes are left out.
        as_json: Whether programs are answered, too.
    """

    at_least: float | None
    by_tree: bool
    quiet: bool
    as_json: bool


def run_dry(asked: Asked, draws: Draws, wanted: Wanted) -> int:
    """Run a mission dry, tell what it has shown, and return the exit status.

    Raises:
        ConfigError: If the mission, the file of mocks or an answer has a mistake.
    """
    from executive.coverage.by_tree import by_tree
    from executive.dry_run.chance import Chance
    from executive.dry_run.rehearsal import rehearse
    from executive.mission.preset_answers import preset_answers
    from executive.tree.load import load_mission

    mission = load_mission(asked.mission, asked.settings)
    preset = preset_answers(asked.answers, mission)
    chances = [Chance(draws.seed + number, draws.failures) for number in range(draws.runs)]
    done = rehearse(mission, chances, asked.mocks, preset, asked.run_dir)
    if wanted.by_tree:
        done = replace(done, coverage=by_tree(done.coverage))
    least, percent = wanted.at_least, done.coverage.percent
    is_enough = least is None or percent >= least
    _tell(done, chances, quiet=wanted.quiet)
    if not is_enough:
        say(f"error: {percent:.1f} % of the branches were taken, not {least:g} %")
    if wanted.as_json:
        answer(_answer(done, chances))
    return 0 if done.is_as_expected and is_enough else 1


def _tell(done: "Rehearsal", chances: Sequence[Any], *, quiet: bool) -> None:
    from executive.coverage.text import coverage_text

    say(f"{done.coverage.mission}, dry: every leaf is mocked; plugins, faults and watch stay away")
    say(f"  {chances[0].told()}")
    for run in done.runs[:_SHOWN]:
        reason = f": {run.result.reason}" if run.result.reason else ""
        say(f"  {run.name}: {run.result.outcome} after {run.result.ended_s:.2f} s{reason}")
    if len(done.runs) > _SHOWN:
        succeeded = sum(run.result.outcome == "success" for run in done.runs)
        say(f"  …: {succeeded} of {len(done.runs)} runs succeeded")
    if not quiet:
        _tell_made_up(done)
        say(f"\n{coverage_text(done.coverage, lists_never=len(done.runs) > 1)}")
    broken = [line for run in done.runs for line in run.broken]
    for line in broken[:_SHOWN]:
        say(line)
    if done.expectations:
        kept = "all met" if not broken else f"not all met ({len(broken)} broken)"
        say(f"expectations: {done.expectations}, {kept}")


def _tell_made_up(done: "Rehearsal") -> None:
    outputs = sorted({name for name in done.made_up if not _is_read(name)})
    read = {name: value for name, value in done.made_up.items() if _is_read(name)}
    if outputs:
        say(f"  made up by their types: {', '.join(outputs)}")
    for name, value in list(read.items())[:_SHOWN]:
        say(f"  made up, and read by the tree: {name} = {value}")
    if len(read) > _SHOWN:
        say(f"  made up, and read by the tree: {len(read) - _SHOWN} more; --json lists all")


def _is_read(name: str) -> bool:
    """Whether a field of an object was read, not an output written."""
    return "." in name


def _answer(done: "Rehearsal", chances: Sequence[Any]) -> dict[str, Any]:
    from executive.coverage.text import coverage_answer
    from executive.events.event import plain

    return {
        "mission": done.coverage.mission,
        "dry": True,
        "failures": chances[0].failures,
        "runs": [
            {
                "seed": run.seed,
                "outcome": run.result.outcome,
                "reason": run.result.reason,
                "ended_s": run.result.ended_s,
                "broken": run.broken,
            }
            for run in done.runs
        ],
        "expectations": done.expectations,
        "as_expected": done.is_as_expected,
        "made_up": {
            name: plain(value) if _is_read(name) else type(value).__name__
            for name, value in done.made_up.items()
        },
        "coverage": coverage_answer(done.coverage),
    }
