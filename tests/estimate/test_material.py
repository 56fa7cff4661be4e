"""A log that was read: where its map begins, and which sensors it has."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.errors import DataError
from executive.estimate.material import Material, _first_fix
from executive.logs.log import Arrival
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample

RIG = SimpleNamespace(name="car", sensors={"gnss_left": None, "gnss_right": None})


def fix(stamp_s: float, antenna: str = "gnss_left", is_rtk_fixed: bool = True) -> Arrival:
    where = np.array([47.0, 8.0, 400.0 + stamp_s])
    return Arrival(stamp_s, GnssFix(stamp_s, antenna, where, np.eye(3), is_rtk_fixed))


def sample(stamp_s: float, frame: str) -> Arrival:
    return Arrival(stamp_s, ImuSample(stamp_s, frame, np.zeros(3), np.zeros(3)))


def material(*arrivals: Arrival) -> Material:
    log = SimpleNamespace(path="a.mcap")
    return Material(log, RIG, arrivals, np.array([47.0, 8.0, 400.0]))  # type: ignore[arg-type]


def test_the_map_begins_at_the_first_fix_with_a_fixed_solution(caplog) -> None:
    arrivals = [sample(0.5, "imu"), fix(1.0, is_rtk_fixed=False), fix(2.0), fix(3.0)]
    assert _first_fix("a.mcap", RIG, arrivals).stamp_s == 2.0
    assert not caplog.records


def test_without_a_fixed_solution_it_begins_at_the_first_fix_with_a_warning(caplog) -> None:
    arrivals = [fix(1.0, is_rtk_fixed=False), fix(2.0, is_rtk_fixed=False)]
    assert _first_fix("a.mcap", RIG, arrivals).stamp_s == 1.0
    assert "none of 2 fixes has a fixed RTK solution" in caplog.text


def test_a_log_without_a_fix_has_no_map() -> None:
    with pytest.raises(DataError, match="the receiver has no fix in the whole log"):
        _first_fix("a.mcap", RIG, [sample(0.5, "imu")])


def test_an_antenna_that_the_rig_lacks_is_named_with_the_cure() -> None:
    with pytest.raises(DataError, match=r"car has no antenna gnss_roof; name the machine"):
        _first_fix("a.mcap", RIG, [fix(1.0), fix(2.0, "gnss_roof")])


def test_a_log_without_inertial_samples_describes_no_body() -> None:
    with pytest.raises(DataError, match=r"^a\.mcap: the inertial topic holds no message$"):
        material(fix(1.0)).body()


def test_a_body_has_its_inertial_sensors_in_order_of_their_first_sample_and_the_datum() -> None:
    body = material(sample(0.0, "b"), fix(0.5), sample(1.0, "a"), sample(2.0, "b")).body()
    assert tuple(body.imus) == ("b", "a")
    assert body.datum == (47.0, 8.0, 400.0)
    assert not body.is_described
