"""The mass of a carried stone from windows whose masses the test makes."""

import numpy as np
import pytest
from executive_plugins.monitoring.carried_mass import CarriedMass


def test_nothing_is_known_before_a_mass_is_above_its_noise() -> None:
    carried = CarriedMass()
    for mass_kg in (0.0, -30.0):
        assert carried.take(mass_kg, 10.0, 0.0, 0.0, may_stand=False).is_unknown
        assert carried.weight is None
    assert carried.take(
        60.0, 10.0, 0.0, 0.0, may_stand=False
    ).is_unknown  # five deviations, of a median, are 62
    signal = CarriedMass().take(63.0, 10.0, 0.0, 0.0, may_stand=False)
    assert signal.value == 1.0


def test_errors_of_the_noise_shrink_with_the_windows_and_those_of_the_lever_do_not() -> None:
    carried = CarriedMass()
    for n in range(1, 26):
        carried.take(500.0, 8.0, 0.012, 0.03, may_stand=False)
        weight = carried.weight
        assert weight is not None
        assert weight.mass_kg == 500.0
        one_kg = np.hypot(8.0, 0.012 * 500.0)  # 10
        assert weight.std_kg == pytest.approx(np.hypot(1.25 * one_kg / np.sqrt(n), 0.03 * 500.0))


def test_the_signal_is_the_share_with_all_of_its_errors() -> None:
    carried = CarriedMass()
    carried.take(500.0, 10.0, 0.0, 0.02, may_stand=False)
    before = carried.weight
    assert before is not None
    signal = carried.take(400.0, 6.0, 0.01, 0.006, may_stand=False)
    assert signal.value == pytest.approx(400.0 / before.mass_kg)
    now_kg = np.hypot(6.0, (0.01 + 0.006) * before.mass_kg)
    assert signal.std == pytest.approx(np.hypot(now_kg, before.std_kg) / before.mass_kg)


def test_the_median_leaves_out_what_the_ground_carries() -> None:
    carried = CarriedMass()
    for mass_kg in (500.0, 502.0, 498.0, 300.0, 501.0):
        carried.take(mass_kg, 10.0, 0.0, 0.0, may_stand=False)
    assert carried.weight is not None
    assert carried.weight.mass_kg == 500.0
    for mass_kg in (240.0, 100.0, 0.0) * 9:  # less than half: it stands on the ground
        assert carried.take(mass_kg, 10.0, 0.0, 0.0, may_stand=False).value == pytest.approx(
            mass_kg / 500.0
        )
    assert carried.weight.mass_kg == 500.0


def test_windows_in_which_it_may_stand_on_something_weigh_nothing() -> None:
    """Set down slowly, the stone stands with a part of its weight, and with all but a part."""
    carried = CarriedMass()
    for mass_kg in (500.0, 502.0, 498.0):
        carried.take(mass_kg, 20.0, 0.0, 0.0, may_stand=False)
    for mass_kg in [300.0] * 20 + [700.0] * 20:
        signal = carried.take(mass_kg, 10.0, 0.0, 0.0, may_stand=True)
        assert signal.value == pytest.approx(mass_kg / 500.0)
    assert carried.weight is not None
    assert carried.weight.mass_kg == 500.0


def test_surer_windows_count_more() -> None:
    carried = CarriedMass()
    carried.take(480.0, 5.0, 0.0, 0.0, may_stand=False)
    for _ in range(3):
        carried.take(500.0, 20.0, 0.0, 0.0, may_stand=False)
    assert carried.weight is not None
    assert carried.weight.mass_kg == 480.0


def test_a_mass_that_is_surely_larger_for_half_a_second_begins_anew() -> None:
    """The stone has left the ground; the error of the lever is not one of the windows alone."""
    carried = CarriedMass()
    for _ in range(9):
        carried.take(300.0, 10.0, 0.0, 0.0, may_stand=False)
    carried.take(349.0, 10.0, 0.0, 0.0, may_stand=False)
    assert carried.weight is not None
    assert carried.weight.mass_kg == 300.0
    carried.take(600.0, 10.0, 0.0, 0.12, may_stand=False)  # 300 more are four deviations
    assert carried.weight.mass_kg == 300.0
    for _ in range(5):
        assert carried.weight.mass_kg == 300.0
        carried.take(351.0, 10.0, 0.0, 0.0, may_stand=False)
    assert carried.weight.mass_kg == 351.0
    assert carried.weight.std_kg < 10.0  # all five count


@pytest.mark.parametrize(("windows", "known_kg"), [(4, 300.0), (5, 390.0)])
def test_a_stone_that_is_caught_as_it_slides_weighs_as_before(
    windows: int, known_kg: float
) -> None:
    carried = CarriedMass()
    for mass_kg in [300.0] * 9 + [390.0] * windows:
        carried.take(mass_kg, 10.0, 0.0, 0.0, may_stand=False)
    assert carried.weight is not None
    assert carried.weight.mass_kg == known_kg
