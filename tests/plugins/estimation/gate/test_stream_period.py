"""How long no fix may come follows from the fixes that came."""

from executive_plugins.estimation.gate.stream_period import StreamPeriod


def test_the_period_is_the_usual_one_whatever_one_outage_was() -> None:
    period = StreamPeriod()
    for stamp_s in (0.0, 1.0, 2.0, 12.0, 13.0, 14.0):
        period.add(stamp_s)
    assert (period.period_s, period.missing_after_s) == (1.0, 2.5)


def test_nothing_is_missing_before_two_fixes_came_and_a_repeated_stamp_is_none() -> None:
    period = StreamPeriod()
    for stamp_s in (5.0, 5.0, 4.0):
        period.add(stamp_s)
    assert period.missing_after_s == 0.0
