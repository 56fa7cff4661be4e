"""Dry runs of one mission, one a seed: what each has shown, and what they cover together."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from executive.coverage.branch import limbs_of
from executive.coverage.coverage import Coverage, CoveredRun
from executive.dry_run.chance import Chance
from executive.dry_run.dry_folder import DryFolder
from executive.dry_run.dry_run import DryOptions, DryResult, DryRun
from executive.dry_run.mock_file import MockFile, read_mocks
from executive.dry_run.places import places_of
from executive.mission.preset_answers import PresetAnswers
from executive.tree.language import MissionFile


@dataclass(frozen=True, slots=True)
class RehearsedRun:
    """One dry run.

    Attributes:
        name: Its seed, and its folder if it has one.
        seed: Its seed.
        result: What it has shown.
        broken: What was expected otherwise, each with its place.
    """

    name: str
    seed: int
    result: DryResult
    broken: list[str]


@dataclass(frozen=True, slots=True)
class Rehearsal:
    """Dry runs of one mission.

    Attributes:
        coverage: The branches that they have taken.
        expectations: Number of expectations of the file of mocks.
        runs: The runs.
        made_up: Names and first values of what was made up.
    """

    coverage: Coverage
    expectations: int
    runs: list[RehearsedRun] = field(default_factory=list)
    made_up: dict[str, Any] = field(default_factory=dict)

    @property
    def is_as_expected(self) -> bool:
        """Whether all expectations were met; where there are none, one run has to succeed.

        Of several runs without expectations none has to: what is drawn is to fail at times.
        """
        if self.expectations:
            return not any(run.broken for run in self.runs)
        return len(self.runs) > 1 or self.runs[0].result.outcome == "success"


def rehearse(
    mission: MissionFile,
    chances: Sequence[Chance],
    mocks: Path | None = None,
    preset: PresetAnswers | None = None,
    folder: Path | None = None,
) -> Rehearsal:
    """Run a mission dry, once for each seed.

    Args:
        mission: The mission.
        chances: The seeds, and the probabilities of what the file does not say.
        mocks: The file of mocks; None draws everything.
        preset: What `--answer` says.
        folder: Where the runs are kept, of several a folder for each seed; None keeps none.

    Raises:
        ConfigError: If the file of mocks has a mistake, or a folder holds a run already.
    """
    places = places_of(mission)
    file = MockFile() if mocks is None else read_mocks(mocks, places)
    coverage = Coverage(mission.name, limbs_of(places.root))
    done = Rehearsal(coverage, file.expectations.count)
    for chance in chances:
        options = DryOptions(chance, file.script, _preset(preset or PresetAnswers()))
        own = folder and (folder / f"seed_{chance.seed}" if len(chances) > 1 else folder)
        result = _run(mission, options, own)
        name = f"seed {chance.seed}"
        of_many = f" ({name})" if len(chances) > 1 else ""
        broken = [f"{line}{of_many}" for line in file.expectations.broken_by(result)]
        done.runs.append(RehearsedRun(name, chance.seed, result, broken))
        done.coverage.add(
            CoveredRun(name, True, result.outcome, result.reason, result.ended_s), result.tally
        )
        for what, value in result.made_up.items():
            done.made_up.setdefault(what, value)
    return done


def _run(mission: MissionFile, options: DryOptions, path: Path | None) -> DryResult:
    if path is None:
        return DryRun(mission, options).run()
    with DryFolder(path, mission) as folder:
        result = DryRun(mission, options, folder.journal).run()
        folder.finish(options.chance, result)
    return result


def _preset(given: PresetAnswers) -> Any:
    def preset(choices: Sequence[str]) -> bool | str | None:
        if not choices:
            return given.answer
        return next((one for one in given.choices if one in choices), None)

    return preset
