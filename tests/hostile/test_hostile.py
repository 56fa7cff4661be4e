"""Damaged files of every format are read or refused by name, quickly and with little memory.

Here some of each format; `python -m tests.hostile --count 10000` reads more and survives crashes.
"""

from pathlib import Path

import pytest

from tests.hostile.formats import FORMATS
from tests.hostile.trial import Answer, attempt, damaged_content

# As many as fit into a tenth of a second; a campaign loads several missions.
_COUNTS = {"mission": 3, "campaign": 1, "bag": 3, "mcap": 4}
_COUNT = 12
_SEED = 7
_ONCE_MISSED = {"bag": [(77, 22)]}  # seed and number of files that ended in a traceback


@pytest.mark.parametrize("name", FORMATS)
def test_a_damaged_file_is_read_or_refused_by_name(name: str, tmp_path: Path) -> None:
    numbered = [(_SEED, number) for number in range(_COUNTS.get(name, _COUNT))]
    kind = FORMATS[name]
    samples = list(kind.make(tmp_path))
    good = [sample.file.read_bytes() for sample in samples]
    for seed, number in [*numbered, *_ONCE_MISSED.get(name, ())]:
        which = number % len(samples)
        content = damaged_content(kind, good[which], (seed, number))
        answer = attempt(kind, samples[which], content)
        samples[which].file.write_bytes(good[which])
        assert not answer.misses(), f"{name} {number}: {answer.text}"


def test_what_misses_a_bound_is_noticed(tmp_path: Path) -> None:
    kind = FORMATS["xyz"]
    sample = next(kind.make(tmp_path))
    assert attempt(kind, sample, sample.file.read_bytes()).outcome == "read"
    assert attempt(kind, sample, b"1 2 x\n").outcome == "refused"
    assert Answer("traceback", "", 9, 0.1, 9).misses() == ["traceback"]
    assert Answer("read", "", 1000, 2.1, 300_000_000).misses() == ["hang", "memory"]
    assert not Answer("read", "", 100_000_000, 2.1, 300_000_000).misses()
