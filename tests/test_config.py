"""Settings that refuse, and quantities with units."""

import math

import pytest
from pydantic import Field, ValidationError

from executive.config import (
    UNITS,
    Kilograms,
    Meters,
    Newtons,
    NoSettings,
    Radians,
    Seconds,
    Settings,
    parse_quantity,
)


class Swing(Settings):
    """Settings as a plugin has them."""

    angle: Radians = Field("120 deg", gt=0, le=7)
    duration: Seconds = Field(20.0, gt=0)
    force: Newtons = 8000.0
    load: Kilograms = 0.0
    radius: Meters = 1.0


@pytest.mark.parametrize(
    ("text", "dimension", "si"),
    [
        ("120 deg", "angle", 2 * math.pi / 3),
        ("-0.5rad", "angle", -0.5),
        ("120 s", "time", 120.0),
        ("2 min", "time", 120.0),
        ("30ms", "time", 0.03),
        ("8 kN", "force", 8000.0),
        ("1.5e3 N", "force", 1500.0),
        (".3 m", "length", 0.3),
        ("30 cm", "length", 0.3),
        ("3 t", "mass", 3000.0),
        ("36 km/h", "speed", 10.0),
        ("2.7 t/m3", "density", 2700.0),
        ("  5 Hz ", "frequency", 5.0),
        (7, "time", 7.0),
        (0.25, "length", 0.25),
    ],
)
def test_quantities_become_si(text: object, dimension: str, si: float) -> None:
    assert parse_quantity(text, dimension) == pytest.approx(si)


@pytest.mark.parametrize(
    "value", [True, None, "", "fast", "3", "1,5 m", "nan m", "inf s", [1], "1 2 s", "1e s", "12:30"]
)
def test_what_is_no_quantity_is_refused_with_the_units(value: object) -> None:
    with pytest.raises(ValueError, match=r"expected a time .*s, ms, min, h"):
        parse_quantity(value, "time")


def test_a_number_that_no_float_holds_is_refused_with_its_digits() -> None:
    with pytest.raises(ValueError, match=r"expected a length .*, got a number of 401 digits"):
        parse_quantity(10**400, "length")


def test_a_unit_of_another_dimension_is_named() -> None:
    with pytest.raises(ValueError, match="'kg' is not a unit of length"):
        parse_quantity("3 kg", "length")


def test_every_dimension_begins_with_its_si_unit() -> None:
    for units in UNITS.values():
        assert next(iter(units.values())) == 1.0


def test_defaults_are_converted_and_checked_too() -> None:
    assert Swing().angle == pytest.approx(2 * math.pi / 3)

    class Wrong(Settings):
        radius_m: float = Field(-1.0, gt=0)

    with pytest.raises(ValidationError, match="greater than 0"):
        Wrong()


def test_a_unit_is_converted_before_the_bound_is_checked() -> None:
    assert Swing(angle="360 deg").angle == pytest.approx(2 * math.pi)
    with pytest.raises(ValidationError, match="less than or equal to 7"):
        Swing(angle="500 deg")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"angel": 1.0}, "Extra inputs"),
        ({"angle": "wide"}, "expected an angle"),
        ({"duration": float("nan")}, "finite"),
        ({"duration": -1}, "greater than 0"),
    ],
)
def test_unknown_and_impossible_settings_are_refused(
    settings: dict[str, object], message: str
) -> None:
    with pytest.raises(ValidationError, match=message):
        Swing(**settings)


def test_settings_do_not_change() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        Swing().angle = 1.0


def test_no_settings_means_none() -> None:
    with pytest.raises(ValidationError, match="Extra inputs"):
        NoSettings(anything=1)


def test_the_schema_tells_an_editor_what_a_quantity_may_be() -> None:
    angle = Swing.model_json_schema()["properties"]["angle"]
    assert {"type": "number"} in angle["anyOf"]
    assert {"type": "string"} in angle["anyOf"]
