"""A campaign's table to a checked campaign; every mistake is noted at its place."""

import hashlib
import json
from collections.abc import Iterator, Sequence

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.comparisons import ComparisonReader
from executive.campaign.description.grid import Grid, levels_of, read_grid
from executive.campaign.description.limits import read_limits
from executive.campaign.description.metrics import MetricReader
from executive.campaign.description.paths import Paths
from executive.campaign.description.seeds import MOST, read_seeds
from executive.campaign.trial import Limits, Trial
from executive.tree.reading import Reading
from executive.tree.resolved import yaml_text
from executive.tree.sources import check_api
from executive.tree.value import Table, plain

KEYS = (
    "api",
    "campaign",
    "description",
    "work",
    "arguments",
    "missions",
    "seeds",
    "set",
    "answers",
    "factors",
    "variants",
    "limits",
    "metrics",
    "compare",
)


def read_campaign(
    table: Table, paths: Paths, reading: Reading, command: str, *, has_trials: bool = True
) -> Campaign:
    """Return the campaign of a table; without trials, no mission is read.

    Raises:
        MissionFileError: If there is any mistake; it holds all of them, with their places.
    """
    reading.known_keys(table, KEYS, "a campaign file")
    check_api(table, reading)
    name, description = _titles(table, reading)
    grid = read_grid(table, paths, reading, has_cells=has_trials)
    seeds = _seeds(table, reading)
    limits = table.get("limits")
    limits_table = None if limits is None else reading.table(limits, "'limits'")
    run_limits = read_limits(limits_table, reading)
    of_metrics = MetricReader(grid.factors, reading)
    metrics, bounds = of_metrics.read(table.get("metrics"))
    comparisons = ComparisonReader(grid.factors, metrics, of_metrics, reading)
    compared = comparisons.read(table.get("compare"))
    if len(seeds) * len(grid.cells) > MOST:
        reading.fail(table, f"more than {MOST:,} runs")
    reading.problems.raise_errors()
    trials = tuple(_trials(seeds, grid, run_limits))
    return Campaign(
        name=name,
        description=description,
        trials=trials,
        factors=dict(levels_of(grid.factors)),
        metrics=metrics,
        bounds=bounds,
        comparisons=compared,
        digest=digest_of(trials),
        command=command,
        text=yaml_text(plain(paths.made_absolute(table))),
        warnings=tuple(str(one) for one in reading.problems.warnings()),
    )


def digest_of(trials: Sequence[Trial]) -> str:
    """Return a hash over what determines the answers of trials: all but their limits.

    A campaign whose limits or bounds were changed can be continued; one with another seed, level,
    setting or mission cannot.
    """
    digest = hashlib.sha256()
    known: dict[int, str] = {}  # the trials of a cell share their arguments
    for trial in trials:
        key = id(trial.arguments)
        if key not in known:
            known[key] = json.dumps(trial.arguments, sort_keys=True)
        levels = json.dumps(trial.levels, sort_keys=True)
        digest.update(f"{trial.work}\n{trial.seed}\n{levels}\n{known[key]}\n".encode())
    return digest.hexdigest()


def _trials(seeds: Sequence[int], grid: Grid, limits: Limits) -> Iterator[Trial]:
    number = 0
    for seed in seeds:
        for levels, arguments in grid.cells:
            yield Trial(number, grid.work, arguments, seed, levels, limits)
            number += 1


def _titles(table: Table, reading: Reading) -> tuple[str, str]:
    name, description = table.get("campaign"), table.get("description")
    if name is None:
        reading.fail(table, "'campaign' is missing: the campaign's name")
    title = reading.name(name, "'campaign'") if name is not None else None
    line = reading.text(description, "'description'") if description is not None else None
    return title or "", line or ""


def _seeds(table: Table, reading: Reading) -> tuple[int, ...]:
    value = table.get("seeds")
    if value is None:
        told = "'seeds' is missing: 1:20 are twenty seeds; --seeds gives them on the command line"
        reading.fail(table, told)
        return ()
    return read_seeds(value, reading)
