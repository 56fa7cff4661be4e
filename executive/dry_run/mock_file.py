"""Reads the file of `--mocks`: what the leaves do, and what the run is expected to show."""

from dataclasses import dataclass, field
from pathlib import Path

from executive.dry_run.expectation_reader import ExpectationReader
from executive.dry_run.expectations import Expectations
from executive.dry_run.places import Places
from executive.dry_run.script import Script
from executive.dry_run.script_reader import ScriptReader
from executive.tree.catalogue import InstalledCatalogue
from executive.tree.document import read_file
from executive.tree.problem import Problems
from executive.tree.reading import Reading
from executive.tree.sources import check_api, shown

_KEYS = ("api", "mocks", "expect")


@dataclass(frozen=True, slots=True)
class MockFile:
    """What a file says.

    Attributes:
        script: What the leaves do.
        expectations: What the run is expected to show.
    """

    script: Script = field(default_factory=Script)
    expectations: Expectations = field(default_factory=Expectations)


def read_mocks(path: Path, places: Places) -> MockFile:
    """Read a file of mocks for the tree of a mission.

    Raises:
        MissionFileError: If there is any mistake; it holds all of them, with their places.
    """
    problems = Problems()
    reading = Reading(InstalledCatalogue(), problems)
    value = read_file(path, shown(path), problems, "file of mocks")
    table = reading.table(value, "a file of mocks") if value is not None else None
    if table is None:
        problems.raise_errors()
        return MockFile()
    reading.known_keys(table, _KEYS, "a file of mocks")
    check_api(table, reading)
    mocks, expect = table.get("mocks"), table.get("expect")
    if mocks is None and expect is None:
        reading.fail(table, "a file of mocks says 'mocks', 'expect' or both")
    script = ScriptReader(places, reading).script(mocks)
    expectations = ExpectationReader(places, reading).expectations(expect)
    problems.raise_errors()
    return MockFile(script, expectations)
