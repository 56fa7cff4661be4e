"""Settings that refuse unknown fields, and quantities with units."""

import math
import re
import types
import typing
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, WithJsonSchema
from pydantic.fields import FieldInfo


class Settings(BaseModel):
    """Base of every settings class: frozen, no unknown fields, defaults checked, finite numbers."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", validate_default=True, allow_inf_nan=False
    )


class NoSettings(Settings):
    """Settings of a node or plugin that has none."""


# The factor from each unit to SI, by dimension.
UNITS: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3},
    "angle": {"rad": 1.0, "deg": math.pi / 180},
    "force": {"N": 1.0, "kN": 1e3},
    "mass": {"kg": 1.0, "t": 1e3},
    "speed": {"m/s": 1.0, "cm/s": 1e-2, "km/h": 1 / 3.6},
    "angular speed": {"rad/s": 1.0, "deg/s": math.pi / 180},
    "volume": {"m3": 1.0, "l": 1e-3},
    "density": {"kg/m3": 1.0, "t/m3": 1e3},
    "frequency": {"Hz": 1.0, "kHz": 1e3},
    "data size": {"B": 1.0, "MB": 1e6, "GB": 1e9, "MiB": 2.0**20, "GiB": 2.0**30},
}
_QUANTITY = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-z/][A-Za-z0-9/]*)\s*"
)


def parse_quantity(value: Any, dimension: str) -> float:
    """Return a quantity such as `"120 deg"` in SI units; a plain number is in SI units already.

    Raises:
        ValueError: If it is not a number, or its unit is unknown or of another dimension; the
            message lists the units.
    """
    if isinstance(value, bool) or value is None:
        got = "nothing" if value is None else str(value).lower()
        raise ValueError(f"expected {expected(dimension)}, got {got}")
    if isinstance(value, int | float):
        try:
            return float(value)
        except OverflowError:
            digits = int(math.log10(abs(value))) + 1
            raise ValueError(
                f"expected {expected(dimension)}, got a number of {digits} digits"
            ) from None
    match = _QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        raise ValueError(f"expected {expected(dimension)}, got {value!r}")
    number, unit = match.groups()
    if unit not in UNITS[dimension]:
        raise ValueError(
            f"'{unit}' is not a unit of {dimension}; expected {expected(dimension)}, got {value!r}"
        )
    return float(number) * UNITS[dimension][unit]


def expected(dimension: str) -> str:
    """Say in which units a quantity of a dimension is given: "a time (a number in s, …)"."""
    units = list(UNITS[dimension])
    article = "an" if dimension.startswith("a") else "a"
    return f"{article} {dimension} (a number in {units[0]}, or with a unit: {', '.join(units)})"


@dataclass(frozen=True, slots=True)
class Quantity:
    """Marks the type of a setting as a quantity of a dimension of `UNITS`."""

    dimension: str


def marks_of(field: FieldInfo) -> tuple[Any, ...]:
    """Return what annotates a field, and the members of its union, as in `Meters | None`."""
    kind = field.annotation
    if typing.get_origin(kind) not in (typing.Union, types.UnionType):
        return tuple(field.metadata)
    annotated = [one for one in typing.get_args(kind) if typing.get_origin(one) is Annotated]
    return (*field.metadata, *(mark for one in annotated for mark in typing.get_args(one)[1:]))


def dimension_of(field: FieldInfo) -> str:
    """Return the dimension of a field of settings; empty if it is no quantity."""
    return next((one.dimension for one in marks_of(field) if isinstance(one, Quantity)), "")


def _quantity(dimension: str) -> Any:
    schema = {
        "anyOf": [{"type": "number"}, {"type": "string"}],
        "description": expected(dimension),
    }
    return (
        Quantity(dimension),
        BeforeValidator(lambda value: parse_quantity(value, dimension)),
        WithJsonSchema(schema),
    )


Seconds = Annotated[float, *_quantity("time")]
Meters = Annotated[float, *_quantity("length")]
Radians = Annotated[float, *_quantity("angle")]
Newtons = Annotated[float, *_quantity("force")]
Kilograms = Annotated[float, *_quantity("mass")]
MetersPerSecond = Annotated[float, *_quantity("speed")]
RadiansPerSecond = Annotated[float, *_quantity("angular speed")]
CubicMeters = Annotated[float, *_quantity("volume")]
KilogramsPerCubicMeter = Annotated[float, *_quantity("density")]
Hertz = Annotated[float, *_quantity("frequency")]
Bytes = Annotated[float, *_quantity("data size")]
