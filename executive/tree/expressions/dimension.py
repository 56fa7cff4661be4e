"""Dimensions of numbers: what may be added and compared, and what a product has."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.config import UNITS

_BASES = ("m", "kg", "s", "rad", "B")
_ANGLE = _BASES.index("rad")

# Exponents of metre, kilogram, second, radian and byte, by the names of `executive.config.UNITS`.
_EXPONENTS: Mapping[str, tuple[int, ...]] = {
    "time": (0, 0, 1, 0, 0),
    "length": (1, 0, 0, 0, 0),
    "angle": (0, 0, 0, 1, 0),
    "force": (1, 1, -2, 0, 0),
    "mass": (0, 1, 0, 0, 0),
    "speed": (1, 0, -1, 0, 0),
    "angular speed": (0, 0, -1, 1, 0),
    "volume": (3, 0, 0, 0, 0),
    "density": (-3, 1, 0, 0, 0),
    "frequency": (0, 0, -1, 0, 0),
    "data size": (0, 0, 0, 0, 1),
}


@dataclass(frozen=True, slots=True)
class Dimension:
    """Exponents of the base units, or a plain number, which is taken as SI where it is added.

    A plain number, such as `3` or a count, adds to and compares with every dimension, because the
    language reads a number without a unit in SI units everywhere. As a factor it has no dimension.
    """

    exponents: tuple[int, ...] = (0,) * len(_BASES)
    is_plain: bool = False

    def __str__(self) -> str:
        for name, exponents in _EXPONENTS.items():
            if exponents == self.exponents:
                return name
        powers = zip(_BASES, self.exponents, strict=True)
        told = [base if power == 1 else f"{base}^{power}" for base, power in powers if power]
        return f"number in {'·'.join(told)}" if told else "number without unit"

    def __mul__(self, other: "Dimension") -> "Dimension":
        return self._joined(other, 1)

    def __truediv__(self, other: "Dimension") -> "Dimension":
        return self._joined(other, -1)

    def suits(self, other: "Dimension") -> bool:
        """Whether two numbers may be added and compared.

        An angle times a length is an arc, so that the radian counts only where nothing else does.
        """
        if self.is_plain or other.is_plain or self.exponents == other.exponents:
            return True
        if _without_angle(self) != _without_angle(other):
            return False
        is_ratio = not any(self.exponents) or not any(other.exponents)
        return any(_without_angle(self)) or is_ratio

    def _joined(self, other: "Dimension", sign: int) -> "Dimension":
        powers = zip(self.exponents, other.exponents, strict=True)
        exponents = tuple(one + sign * two for one, two in powers)
        return Dimension(exponents, self.is_plain and other.is_plain)


PLAIN = Dimension(is_plain=True)
NAMED = {name: Dimension(exponents) for name, exponents in _EXPONENTS.items()}
_OF_UNIT = {unit: (name, factor) for name, units in UNITS.items() for unit, factor in units.items()}


def unit_dimension(unit: str) -> Dimension:
    """Return the dimension of a unit."""
    return NAMED[_OF_UNIT[unit][0]]


def in_si(value: float, unit: str) -> int | float:
    """Return a quantity in SI units; a number without a unit stays as it is."""
    return value * _OF_UNIT[unit][1] if unit else value


def _without_angle(one: Dimension) -> tuple[int, ...]:
    return one.exponents[:_ANGLE] + one.exponents[_ANGLE + 1 :]
