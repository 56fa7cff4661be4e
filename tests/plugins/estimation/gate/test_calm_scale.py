"""An alarm is judged by the noise that was known before it, for some time."""

from executive_plugins.estimation.gate.calm_scale import calm_factor, calm_scale


def test_the_newest_scale_counts_without_an_alarm() -> None:
    scale = calm_scale(10.0, 4.0)
    assert calm_factor(scale, 0.0, False, 2.0) == 2.0
    assert calm_factor(scale, 1.0, False, 3.0) == 3.0


def test_an_alarm_keeps_the_scale_of_before_it_and_noise_that_stays_is_believed() -> None:
    scale = calm_scale(10.0)
    calm_factor(scale, 5.0, False, 2.0)
    assert calm_factor(scale, 6.0, True, 25.0) == 2.0
    assert calm_factor(scale, 15.0, True, 25.0) == 2.0
    assert calm_factor(scale, 15.1, True, 20.0) == 20.0


def test_the_time_begins_anew_with_the_next_alarm() -> None:
    scale = calm_scale(10.0)
    calm_factor(scale, 5.0, False, 2.0)
    calm_factor(scale, 14.0, True, 25.0)
    assert calm_factor(scale, 14.5, False, 3.0) == 3.0
    assert calm_factor(scale, 20.0, True, 25.0) == 3.0
