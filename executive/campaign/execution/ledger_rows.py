"""How trials and outcomes stand in the tables of a ledger."""

import json
import zlib
from collections.abc import Mapping
from typing import Any

from executive.campaign.trial import Limits, Outcome, Status, Trial

FORM = 1  # of the tables; to be raised when they change
SCHEMA = """
CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS sessions (
    session INTEGER PRIMARY KEY, begun TEXT NOT NULL, owner TEXT NOT NULL, command TEXT NOT NULL,
    version TEXT NOT NULL, source TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS arguments (
    arguments INTEGER PRIMARY KEY, text TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS trials (
    number INTEGER PRIMARY KEY, work TEXT NOT NULL, arguments INTEGER NOT NULL REFERENCES arguments,
    seed INTEGER NOT NULL, levels TEXT NOT NULL, time_s REAL NOT NULL,
    memory_bytes INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS tries (
    number INTEGER NOT NULL REFERENCES trials, try INTEGER NOT NULL,
    session INTEGER NOT NULL REFERENCES sessions, state TEXT NOT NULL, reason TEXT NOT NULL,
    PRIMARY KEY (number, try)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS outcomes (
    number INTEGER PRIMARY KEY REFERENCES trials, status TEXT NOT NULL, reason TEXT NOT NULL,
    answer BLOB NOT NULL, wall_s REAL NOT NULL, cpu_s REAL NOT NULL,
    peak_memory_bytes INTEGER NOT NULL, tries INTEGER NOT NULL, worker TEXT NOT NULL);
"""

SELECT_TRIALS = """
SELECT number, work, arguments, seed, levels, time_s, memory_bytes FROM trials ORDER BY number
"""
SELECT_OUTCOMES = """
SELECT number, status, reason, answer, wall_s, cpu_s, peak_memory_bytes, tries, worker
FROM outcomes ORDER BY number
"""
SELECT_PENDING = """
SELECT number FROM trials
WHERE number NOT IN (SELECT number FROM outcomes)
AND number NOT IN (SELECT number FROM tries WHERE state = 'claimed')
ORDER BY number
"""


def trial_row(trial: Trial, numbers: dict[str, int]) -> tuple[object, ...]:
    """Return the row of a trial; `numbers` holds that of each arguments, new ones are added."""
    text = json.dumps(dict(trial.arguments))
    arguments = numbers.setdefault(text, len(numbers))
    levels, limits = json.dumps(dict(trial.levels)), trial.limits
    return (
        *(trial.number, trial.work, arguments, trial.seed, levels),
        *(limits.time_s, limits.memory_bytes),
    )


def trial_of(row: tuple[Any, ...], arguments: Mapping[int, Mapping[str, Any]]) -> Trial:
    """Return the trial of a row, with its arguments by their number."""
    number, work, which, seed, levels, time_s, memory_bytes = row
    limits = Limits(time_s, memory_bytes)
    return Trial(number, work, arguments[which], seed, json.loads(levels), limits)


def outcome_row(outcome: Outcome) -> tuple[object, ...]:
    """Return the row of an outcome; its answer is compressed."""
    answer = zlib.compress(json.dumps(dict(outcome.answer)).encode())
    return (
        *(outcome.number, outcome.status.value, outcome.reason, answer, outcome.wall_s),
        *(outcome.cpu_s, outcome.peak_memory_bytes, outcome.tries, outcome.worker),
    )


def outcome_of(row: tuple[Any, ...]) -> Outcome:
    """Return the outcome of a row."""
    number, status, reason, answer, *took = row
    return Outcome(number, Status(status), reason, json.loads(zlib.decompress(answer)), *took)
