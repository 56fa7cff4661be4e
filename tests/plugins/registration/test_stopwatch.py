"""Times by stage on a clock that is set by hand."""

import pytest
from executive_plugins.registration import stopwatch
from executive_plugins.registration.stopwatch import Stopwatch


def test_a_stage_adds_up_and_the_total_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter((100.0, 101.0, 101.5, 102.0, 104.0, 105.0, 105.25, 110.0))
    monkeypatch.setattr(stopwatch, "wall_s", lambda: next(clock))
    watch = Stopwatch()
    for name in ("match", "refine", "match"):
        with watch.stage(name):
            pass
    assert watch.timings_ms() == {"match": 750.0, "refine": 2000.0, "total": 10_000.0}
