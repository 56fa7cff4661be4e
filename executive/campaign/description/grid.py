"""Reads what the runs of a campaign are given: work, settings, factors, checked cell by cell."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from executive.campaign.description.cells import Checker, cells_of
from executive.campaign.description.factors import (
    Factor,
    read_factors,
    read_missions,
    read_settings,
    read_variants,
    refuse_conflicts,
)
from executive.campaign.description.mission_cells import WORK, MissionCells
from executive.campaign.description.paths import Paths
from executive.campaign.description.work_cells import WorkCells, find_work
from executive.tree.reading import Reading
from executive.tree.value import Table

MOST_CELLS = 10_000  # each is loaded and checked, which takes some 20 ms


@dataclass(frozen=True, slots=True)
class Grid:
    """What is varied, and what the runs of each combination of levels are given.

    Attributes:
        work: Installed name of the work.
        factors: Factors with several levels; a factor of one level has nothing to compare.
        cells: The level of each of them, and the arguments.
    """

    work: str
    factors: tuple[Factor, ...]
    cells: tuple[tuple[Mapping[str, str], Mapping[str, Any]], ...]


def read_grid(table: Table, paths: Paths, reading: Reading, *, has_cells: bool = True) -> Grid:
    """Return the grid; it lacks cells if there are mistakes, all of which are noted."""
    factors = _factors(table, reading)
    varied = tuple(factor for factor in factors if len(factor.levels) > 1)
    if not has_cells:
        return Grid("", varied, ())
    common = _section(table, "set", reading)
    settings = read_settings(common, reading) if common else ()
    work, checker = _checker(table, paths, reading)
    if prod(max(1, len(factor.levels)) for factor in factors) > MOST_CELLS:
        reading.fail(table, f"the factors make more than {MOST_CELLS:,} combinations of levels")
    elif checker is not None:
        names = {factor.name for factor in varied}
        cells = (
            ({k: v for k, v in cell.levels.items() if k in names}, arguments)
            for cell in cells_of(settings, factors)
            if (arguments := checker.arguments(cell)) is not None
        )
        grid = Grid(work, varied, tuple(cells))
        checker.finish()
        return grid
    return Grid(work, varied, ())


def _factors(table: Table, reading: Reading) -> Sequence[Factor]:
    """Return all factors, the missions first."""
    if "factors" in table.entries and "variants" in table.entries:
        told = "'factors' and 'variants' exclude each other; write the variants as a factor"
        reading.problems.error(table.entries["variants"].key_mark, told)
    missions = table.get("missions")
    found = read_missions(missions, reading) if missions is not None else None
    factors, variants = (_section(table, key, reading) for key in ("factors", "variants"))
    every = [
        *([found] if found else []),
        *(read_factors(factors, reading) if factors else []),
        *(read_variants(variants, reading) if variants else []),
    ]
    refuse_conflicts(every, reading)
    return every


def _checker(table: Table, paths: Paths, reading: Reading) -> tuple[str, Checker | None]:
    value = table.get("work")
    found = find_work(value, reading) if value is not None else None
    if value is not None and found is None:
        return "", None
    if found is None or found[0] == WORK:
        _refuse(table, ["arguments"], "missions take settings, under 'set'", reading)
        return WORK, MissionCells(table, paths, reading)
    why = f"the work is '{found[0]}', which runs no mission"
    _refuse(table, ["missions", "answers"], why, reading)
    arguments = _section(table, "arguments", reading) or Table({}, table.mark)
    return found[0], WorkCells(found, arguments, paths, reading)


def _refuse(table: Table, keys: Sequence[str], why: str, reading: Reading) -> None:
    for key in keys:
        if key in table.entries:
            reading.problems.error(table.entries[key].key_mark, f"no '{key}' here: {why}")


def _section(table: Table, key: str, reading: Reading) -> Table | None:
    value = table.get(key)
    return None if value is None else reading.table(value, f"'{key}'")


def levels_of(factors: Sequence[Factor]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield each factor with the names of its levels."""
    for factor in factors:
        yield factor.name, tuple(level.name for level in factor.levels)
